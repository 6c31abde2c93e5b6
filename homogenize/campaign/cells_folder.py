"""The folder in which a user's unit cells are kept, for all projects and processes.

Cells are files of `kept_samples`, which appear whole and never change: a second writer writes the same file, and a
process that is killed leaves none. The oldest ones go when there are many.
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

import platformdirs

from asterism.homogenize.errors import CampaignError

# names another folder
FOLDER_VARIABLE = "ASTERISM_CELLS"
# of about 10 kB each
MAX_KEPT_CELLS = 10_000


def cells_folder() -> Path:
    """The folder, which exists afterwards; that of the environment variable `ASTERISM_CELLS`, if it is set.

    Raises
    ------
    CampaignError
        The folder cannot be made.
    """
    own = os.environ.get(FOLDER_VARIABLE)
    folder = Path(own) if own else Path(platformdirs.user_cache_dir("asterism", appauthor=False)) / "cells"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        problem = f"cannot make the folder of the cells, {folder}: {reason}; {FOLDER_VARIABLE} names another"
        raise CampaignError(problem) from None
    return folder


def forget_oldest(folder: Path, most: int = MAX_KEPT_CELLS) -> int:
    """Remove the cells that were solved longest ago, so that at most so many are left; return the number removed."""
    cells = []
    with os.scandir(folder) as entries:
        for entry in entries:
            with suppress(FileNotFoundError):  # another process forgets it at this moment
                if entry.name.endswith(".json"):
                    cells.append((entry.stat().st_mtime, entry.path))
    leaving = sorted(cells)[: max(len(cells) - most, 0)]
    for _, path in leaving:
        with suppress(OSError):  # another process was faster
            os.unlink(path)
    return len(leaving)
