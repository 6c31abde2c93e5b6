"""Meshes on the lines of the lattice."""
