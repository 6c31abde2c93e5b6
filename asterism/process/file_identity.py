"""The identity of a file's content, for what is kept of files that were read."""

from __future__ import annotations

from pathlib import Path


def file_identity(path: str | Path) -> tuple[int, ...]:
    """Numbers that change when a file is replaced or written again: device, inode, bytes, and times in ns.

    Raises
    ------
    OSError
        There is no such file.
    """
    stat = Path(path).stat()
    return stat.st_dev, stat.st_ino, stat.st_size, stat.st_mtime_ns, stat.st_ctime_ns
