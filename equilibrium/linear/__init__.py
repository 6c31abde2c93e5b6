"""Sparse linear algebra: sparsity patterns, factorisations, multigrid."""
