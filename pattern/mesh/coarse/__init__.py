"""Coarse meshes for shells of high order."""
