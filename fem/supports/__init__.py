"""Supports and loads of the shell: essential conditions by elimination, dead loads."""
