"""Names of rows on the command line of a benchmark."""

from __future__ import annotations

import argparse
from collections.abc import Collection


def chosen_names(parser: argparse.ArgumentParser, given: list[str], known: Collection[str]) -> list[str]:
    """The given names, or all. A name that is not known ends the program with status 2 and one line."""
    for name in given:
        if name not in known:
            parser.exit(2, f"NAME: {name!r} is no row; there are: {'; '.join(known)}\n")
    return given or list(known)
