"""Printed rods: the arms of the stars."""
