"""Energies of the arms as Kirchhoff rods (discrete elastic rods): bending, twist and axial stretch."""
