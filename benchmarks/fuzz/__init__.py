"""Mutated inputs over all commands."""
