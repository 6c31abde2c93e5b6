"""Measurements of real prints."""
