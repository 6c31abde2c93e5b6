"""The bumps laid on the smooth surface."""
