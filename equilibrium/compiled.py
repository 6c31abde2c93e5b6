"""Loops compiled by numba."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from numba import config, njit
from numba.extending import register_jitable

# decorators of formulas, as files contain them
FORMULA_MARKS = (b"@formula", b"@sum_formula")
# names of loops whose machine code no folder keeps: they are compiled in each run
uncached: list[str] = []


def formula(function: Callable[..., Any]) -> Callable[..., Any]:
    """Mark a function of one element: plain Python calls it unchanged, and compiled loops contain it.

    A call would pass every component of its vectors through memory.
    """
    return register_jitable(forceinline=True)(function)


def sum_formula(function: Callable[..., Any]) -> Callable[..., Any]:
    """Mark a formula whose sums may be taken in any order: compiled loops add several terms at once.

    The sums then differ by rounding from those of plain Python, and from those of other processors.
    """
    return register_jitable(fastmath={"reassoc", "contract"})(function)


def loop(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a loop over elements, and cache its machine code on disk between runs, if a folder can be written.

    numba checks only the file of the loop to see whether the machine code is stale. The formulas that the loop calls
    may be in other files, so the name of the cache folder is a digest of all files with formulas.
    """
    folder = Path(function.__code__.co_filename).parent / "__pycache__" / _folder_name(_package_of(function))
    default_folder = config.CACHE_DIR  # type: ignore[attr-defined]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]
    except OSError:  # an installation without write permission: numba chooses another folder
        pass
    try:
        return _compiled(function) if config.DISABLE_JIT else _with_cache(function)  # type: ignore[attr-defined]
    except RuntimeError:  # numba finds no folder that it can write
        uncached.append(function.__name__)
        return _compiled(function)
    finally:
        config.CACHE_DIR = default_folder  # type: ignore[attr-defined]


def has_machine_code(package: Path) -> bool:
    """Whether an earlier run compiled loops of a package, given by its folder, with its present formulas."""
    return any(package.rglob(f"{_folder_name(package)}/**/*.nbi"))


def _folder_name(package: Path) -> str:
    return f"formulas-{_digest(package)}"


def _with_cache(function: Callable[..., Any]) -> Callable[..., Any]:
    """The compiled loop; its machine code is kept unless the disk is full, and made anew where files are damaged."""
    compiled = _compiled(function, cache=True)
    kept = compiled._cache  # type: ignore[attr-defined]
    load, save = kept.load_overload, kept.save_overload

    def load_if_whole(*signature: Any) -> Any:
        try:
            return load(*signature)
        except Exception:  # whatever reading half a file raises
            with suppress(OSError):
                kept.flush()
            return None

    def save_if_possible(*overload: Any) -> None:
        with suppress(OSError):
            save(*overload)

    kept.load_overload, kept.save_overload = load_if_whole, save_if_possible
    return compiled


def _compiled(function: Callable[..., Any], **options: Any) -> Callable[..., Any]:
    # numpy's error model: a division by zero (a collapsed triangle) is an infinite energy, as in plain numpy
    compiled: Callable[..., Any] = njit(nogil=True, error_model="numpy", **options)(function)
    return compiled


def _package_of(function: Callable[..., Any]) -> Path:
    """The folder of the function's package below `asterism`."""
    return Path(function.__code__.co_filename).parents[max(function.__module__.count(".") - 2, 0)]


@cache
def _digest(package: Path) -> str:
    """Digest of all files with formulas that a function of this package may call: those there and beside this file."""
    texts = []
    for name in sorted({*_python_files(package), *_python_files(Path(__file__).parent)}):
        text = Path(name).read_bytes()
        if any(mark in text for mark in FORMULA_MARKS) or name == __file__:
            texts.append(text)
    return hashlib.sha256(b"".join(texts)).hexdigest()[:12]


def _python_files(package: Path) -> Iterator[str]:
    """Paths of all Python files of a package; `Path.rglob` takes three times as long."""
    for folder, inner, files in os.walk(package):
        inner[:] = [each for each in inner if each != "__pycache__"]
        yield from (os.path.join(folder, file) for file in files if file.endswith(".py"))
