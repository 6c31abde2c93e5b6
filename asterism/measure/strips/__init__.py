"""Strips of plastic on fabric: their test print, and the material that their curvatures give."""
