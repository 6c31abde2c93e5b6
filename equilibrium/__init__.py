"""Sparse factorisation and Newton, shared by the exact model and the shell."""
