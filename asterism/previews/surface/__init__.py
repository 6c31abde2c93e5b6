"""The smooth surface and the sheet shown."""
