"""A real browser without a window, where the machine has one.

`python3 tests/asterism/verification/browser.py` prints its path; the exit status is 1 if there is none.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "msedge")
MACOS = Path("/Applications/Google Chrome.app/Contents/MacOS/Google Chrome")


def browser() -> str | None:
    """The program of a Chromium, Chrome or Edge; None if there is none."""
    found = next((path for name in NAMES if (path := shutil.which(name))), None)
    return found or (str(MACOS) if MACOS.exists() else None)


if __name__ == "__main__":
    path = browser()
    print(path or "no browser")
    sys.exit(path is None)
