"""Conformal flattening of a triangulated disk. It knows surfaces, and no sheets."""
