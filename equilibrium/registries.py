"""Registries: the modules of a folder register what they define, and are all loaded before a registry is read."""

from __future__ import annotations

import pkgutil
from functools import cache
from importlib import import_module


@cache
def load_all(package: str) -> None:
    """Import all modules of a package, once."""
    for module in pkgutil.iter_modules(import_module(package).__path__):
        import_module(f"{package}.{module.name}")
