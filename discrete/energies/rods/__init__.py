"""Energies of the rods: stretch, bend, twist."""
