"""Room of the unit cells and of the law of the sheet."""
