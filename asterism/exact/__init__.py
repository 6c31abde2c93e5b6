"""The exact shape of a design."""
