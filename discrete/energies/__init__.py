"""The energies of the exact model: each one a formula for one element, evaluated over all its elements at once."""
