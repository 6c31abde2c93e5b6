"""Bending energies of the fabric: hinges, plate, and the registry in which a design file finds them by name."""
