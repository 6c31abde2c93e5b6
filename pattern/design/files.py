"""Design files: TOML and JSON in, TOML and JSON out; plain data for JSON; folders of the users' own files."""

from __future__ import annotations

import errno
import json
import math
import os
import re
import stat
import tomllib
import uuid
from collections import Counter
from pathlib import Path
from typing import Any

import platformdirs

from asterism.pattern.design.errors import DesignError

# environment variable with the path of a folder that holds printers/, plastics/ and materials/
PROFILES_VARIABLE = "ASTERISM_PROFILES"
MAX_DESIGN_BYTES = 10_000_000
MAX_DEPTH = 100  # of tables and lists in each other; Python's own limit is somewhere below 1000


def read_bytes(path: Path, max_bytes: int = MAX_DESIGN_BYTES) -> bytes:
    """The content of a regular file.

    Raises `OSError` if there is none, it is a pipe, a device or a folder, from which reading might never end, or it is
    larger.
    """
    # a pipe that nobody writes to would not open otherwise
    with open(path, "rb", opener=lambda name, flags: os.open(name, flags | getattr(os, "O_NONBLOCK", 0))) as stream:
        if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
            raise OSError(errno.EINVAL, "it is a pipe or a device, not a file", str(path))
        raw = stream.read(max_bytes + 1)
    if len(raw) > max_bytes:
        raise OSError(errno.EFBIG, f"it is larger than {max_bytes // 1_000_000} MB", str(path))
    return raw


def is_deep(value: Any) -> bool:
    """Whether tables and lists stand in each other more than `MAX_DEPTH` times."""
    level: list[Any] = [[value]]
    for _ in range(MAX_DEPTH):
        inner = (part for each in level for part in (each.values() if isinstance(each, dict) else each))
        level = [part for part in inner if isinstance(part, dict | list)]
        if not level:
            return False
    return True


def read_table(path: Path, max_bytes: int = MAX_DESIGN_BYTES) -> dict[str, Any]:
    """The table in a file, with `DesignError` for everything that can be wrong with one."""

    def wrong(problem: str) -> DesignError:
        return DesignError("", problem, file=path)

    suffix = _suffix(path)
    if os.path.isdir(path):
        raise wrong("is a folder, not a file")
    try:
        raw = read_bytes(path, max_bytes)
    except (OSError, ValueError) as error:
        raise wrong(f"cannot be read: {getattr(error, 'strerror', None) or error}") from None
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise wrong(f"is not UTF-8 text (line {raw[: error.start].count(bytes([10])) + 1})") from None
    if not text.strip():
        raise wrong("is empty")
    try:
        table = tomllib.loads(text) if suffix == ".toml" else json.loads(text, object_pairs_hook=_once)
        if is_deep(table):
            raise RecursionError
        json.dumps(table, ensure_ascii=False, default=str).encode()
    except RecursionError:
        raise wrong("is nested too deeply") from None
    except UnicodeEncodeError:
        raise wrong("holds half a character (\\ud800 to \\udfff alone), which is no text") from None
    except ValueError as error:  # syntax errors of both formats, with their line
        long = "sys.set_int_max_str_digits" in str(error)  # a hint for programmers
        problem = "a whole number has too many digits" if long else f"{error}{_hint(text, str(error))}"
        raise wrong(f"is not {suffix[1:].upper()}: {problem}") from None
    if not isinstance(table, dict):
        raise wrong("must hold a table of keys and values")
    return table


def _hint(text: str, problem: str) -> str:
    """What the reader of TOML does not say: a line sets something twice, or has a number with a comma."""
    if re.match("Cannot (overwrite|declare)", problem):
        return "; what it sets is set before, each key and each table may stand once"
    at = re.search(r"at line (\d+)", problem)
    if "hex value" in problem or "escape" in problem:
        return "; write paths with /"
    line = text.split("\n")[int(at[1]) - 1] if at else ""
    return "; decimals have a point, 7.5" if re.search(r"=\s*[-+]?\d+,\d", line) else ""


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object whose keys are all different, as TOML demands too."""
    table = dict(pairs)
    if len(table) < len(pairs):
        again, _ = Counter(key for key, _ in pairs).most_common(1)[0]
        raise ValueError(f"the key {again!r} is there twice")
    return table


def table_text(table: dict[str, Any], path: Path) -> str:
    """The text of a table in the format that the file's name asks for."""
    if _suffix(path) == ".toml":
        return "\n\n".join(_toml_tables(table, "")) + "\n"
    return json.dumps(table, indent=2, ensure_ascii=False) + "\n"


def write_table(table: dict[str, Any], path: Path) -> None:
    """Write a table; the file appears complete or not at all."""
    text = table_text(table, path)
    unfinished = path.with_name(f".{path.name}.{uuid.uuid4().hex}")
    try:
        with unfinished.open("x", encoding="utf-8", newline="\n") as stream:
            stream.write(text)
        unfinished.replace(path)
    except OSError as error:
        raise type(error)(error.errno, error.strerror, str(path)) from None  # not the name that nobody gave
    finally:
        unfinished.unlink(missing_ok=True)


def plain(value: Any) -> Any:
    """Plain data for JSON, which has no arrays, and no infinity and no not-a-number: these become null."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _toml_tables(table: dict[str, Any], name: str, heading: str = "") -> list[str]:
    """Blocks of TOML: the table's own keys, then its lists of tables; small tables stand inline."""
    blocks: list[str] = []
    lines = [heading] if heading else []
    for key, value in table.items():
        if not name and isinstance(value, dict):
            blocks += _toml_tables(value, key, f"[{key}]")
        elif value and isinstance(value, list) and isinstance(value[0], dict):
            full = f"{name}.{key}" if name else key
            for entry in value:
                blocks += _toml_tables(entry, full, f"[[{full}]]")
        else:
            lines.append(f"{key} = {_toml(value)}")
    return ["\n".join(lines), *blocks] if lines else blocks


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_toml(inner)}" for key, inner in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    # JSON's texts, numbers and booleans are TOML's, but for one control character
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _suffix(path: Path) -> str:
    suffix = path.suffix.lower()
    if suffix not in (".toml", ".json"):
        raise DesignError("", "must end in .toml or .json", file=path)
    return suffix


def own_folders() -> list[Path]:
    """The folders in the order of the search: that of `ASTERISM_PROFILES`, if it is set, and that of the user."""
    own = [Path(os.environ[PROFILES_VARIABLE])] if os.environ.get(PROFILES_VARIABLE) else []
    return [*own, user_folder()]


def user_folder() -> Path:
    """The folder of the user's settings for asterism, where the operating system keeps such folders."""
    return platformdirs.user_config_path("asterism", appauthor=False, roaming=True)


def file_identity(path: str | Path) -> tuple[int, ...]:
    """Numbers that change when a file is replaced or written again: device, inode, bytes, and times in ns.

    Raises `OSError` if there is no such file.
    """
    now = Path(path).stat()
    return now.st_dev, now.st_ino, now.st_size, now.st_mtime_ns, now.st_ctime_ns
