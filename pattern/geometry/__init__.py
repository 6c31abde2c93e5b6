"""Plane and space geometry in numpy."""
