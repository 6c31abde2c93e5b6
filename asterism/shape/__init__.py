"""Shapes of a sheet in space, their measures and their comparison."""
