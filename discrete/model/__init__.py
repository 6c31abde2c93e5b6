"""The exact model: its unknowns, its energies over them, its supports, and the curves along which it steps."""
