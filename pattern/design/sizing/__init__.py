"""Sizing profiles: quantities that vary over the sheet."""
