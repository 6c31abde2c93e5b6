"""Pins and weight as supports and loads."""
