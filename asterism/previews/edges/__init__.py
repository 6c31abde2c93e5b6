"""Free and supported edges of the sheet."""
