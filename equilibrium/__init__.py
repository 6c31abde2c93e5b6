"""Sparse factorisations and Newton's method, shared by the exact model and the shell."""
