"""Comparison of a computed shape with a printed sheet: a scan in space, or an outline from a photograph."""
