"""Discretisations of the shell: Argyris triangles (C1)."""
