"""Discretisations of the shell: Argyris triangles (C1), and P2 or P3 triangles with a discrete Hessian."""
