"""How far off a preview may be."""
