"""Sweeps: one design computed for many values of some of its entries."""
