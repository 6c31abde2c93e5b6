"""Test strips of plastic on fabric: the print, the table of measurements, and the fitted material."""
