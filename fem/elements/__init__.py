"""Finite elements for the shell."""
