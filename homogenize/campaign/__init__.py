"""Campaigns of unit cells, and the fit of a law to their samples."""
