"""The exact model: energies, unknowns, constraints."""
