"""Constrained Delaunay meshes."""
