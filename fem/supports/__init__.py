"""Supports and loads of the shell."""
