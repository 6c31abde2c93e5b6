"""Follows a design file that somebody edits in a text editor."""

from __future__ import annotations

from pathlib import Path


def file_text(path: Path) -> str:
    """The text of a file with its line ends, so that it can be written back byte for byte."""
    with path.open(encoding="utf-8-sig", newline="") as stream:
        return stream.read()


class FileWatch:
    """Compares a file with what it held before.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "a.toml"
    >>> watch = FileWatch(path)
    >>> _ = path.write_text("x = 1")
    >>> watch.changed_text(), watch.changed_text()
    ('x = 1', None)
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._stamp: tuple[int, int] | None = None
        self._text: str | None = None
        self.changed_text()

    def changed_text(self) -> str | None:
        """The text of the file if it differs from the last time; None otherwise, and while the file cannot be read."""
        try:
            status = self._path.stat()
            stamp = (status.st_mtime_ns, status.st_size)
            if stamp == self._stamp:
                return None
            text = file_text(self._path)
        except (OSError, ValueError):
            return None
        self._stamp = stamp
        if text == self._text:
            return None
        self._text = text
        return text
