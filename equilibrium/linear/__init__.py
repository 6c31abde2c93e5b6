"""Sparse linear algebra: patterns, factorisations, multigrid."""
