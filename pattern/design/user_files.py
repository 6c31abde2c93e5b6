"""Folders in which users keep files of their own: printers, plastics and measured materials."""

from __future__ import annotations

import os
import sys
from pathlib import Path

# environment variable with the path of a folder that holds printers/, plastics/ and materials/
PROFILES_VARIABLE = "ASTERISM_PROFILES"


def own_folders() -> list[Path]:
    """The folders in the order of the search: that of `ASTERISM_PROFILES`, if it is set, and that of the user."""
    own = [Path(os.environ[PROFILES_VARIABLE])] if os.environ.get(PROFILES_VARIABLE) else []
    return [*own, user_folder()]


def user_folder() -> Path:
    """The folder of the user's settings for asterism, where the operating system keeps such folders."""
    if sys.platform == "win32":
        return Path(os.environ.get("APPDATA", Path.home())) / "asterism"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support" / "asterism"
    return Path(os.environ.get("XDG_CONFIG_HOME", Path.home() / ".config")) / "asterism"
