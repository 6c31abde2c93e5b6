"""Drawings of other programs, SVG, DXF and 3DM, in one neutral form."""
