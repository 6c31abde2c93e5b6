"""Plane and space geometry, without any knowledge of designs."""
