"""Campaigns of unit cells."""
