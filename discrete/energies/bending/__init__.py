"""Bending energies of the fabric."""
