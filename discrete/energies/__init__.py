"""The energies of the exact model."""
