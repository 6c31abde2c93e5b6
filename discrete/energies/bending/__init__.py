"""Bending energies of the fabric: hinges and plate, found by the names in the design file."""
