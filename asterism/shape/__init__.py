"""Shapes in space and their measures."""
