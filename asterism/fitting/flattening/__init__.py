"""Conformal flattening of a triangulated disk, independent of stars and sheets."""
