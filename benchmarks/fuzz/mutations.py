"""Mutations of texts, bytes and tables, each drawn from a generator of random numbers."""

from __future__ import annotations

import copy
import io
import json
from functools import reduce
from operator import getitem
from typing import Any

import numpy as np

Rng = np.random.Generator

# values that some key, option or cell does not expect
ODD_VALUES: tuple[Any, ...] = (
    0, -1, 1, 2, 1e-9, 1e9, 1e308, -0.0, 0.5, 3.0, 17, float("nan"), float("inf"), 10**30, True, False, "", "text",
    "7.5", "\u661f", "x" * 200, [], [1.0], [1.0, 2.0], [[0.0, 0.0], [1.0, 1.0]], {}, {"formula": "x/0"},
    {"profile": "radial", "from": 9, "to": 5, "over_mm": 60}, {"image": "none.png"},
)  # fmt: skip
FACTORS = (0.01, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 1.05, 1.1, 1.25, 1.5, 2.0, 3.0, 10.0, 100.0, -1.0)


def pick(rng: Rng, values: Any) -> Any:
    """One of several values, which may be of different kinds."""
    values = list(values)
    return values[int(rng.integers(len(values)))]


def _changes(rng: Rng) -> int:
    """Mostly one change, so that the input stays near the limit of what is allowed."""
    return 1 if rng.random() < 0.7 else int(rng.integers(2, 4))


def places(table: Any, above: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """All keys and indices of nested tables and lists, as paths."""
    entries = table.items() if isinstance(table, dict) else enumerate(table) if isinstance(table, list) else ()
    paths: list[tuple[Any, ...]] = []
    for key, value in entries:
        paths += [(*above, key), *places(value, (*above, key))]
    return paths


def mutated_table(table: dict[str, Any], rng: Rng, known_keys: tuple[str, ...] = ()) -> dict[str, Any]:
    """A copy of a table with one to three changes: other numbers, odd values, missing, misplaced and unknown keys."""
    table = copy.deepcopy(table)
    for _ in range(_changes(rng)):
        paths = places(table)
        if not paths:
            return table
        numbers = [path for path in paths if isinstance(reduce(getitem, path, table), int | float)]
        *above, key = pick(rng, numbers if numbers and rng.random() < 0.5 else paths)
        home = reduce(getitem, above, table)
        value = home[key]
        kind = rng.random()
        if kind < 0.8 and isinstance(value, int | float) and not isinstance(value, bool):
            changed = value * pick(rng, FACTORS)
            home[key] = round(changed) if isinstance(value, int) else changed
        elif kind < 0.87:
            home[key] = copy.deepcopy(pick(rng, ODD_VALUES))
        elif kind < 0.91:
            del home[key]
        elif kind < 0.94 and isinstance(home, dict):
            home[pick(rng, ("lenght_mm", "stretch", "edge_mm", *known_keys))] = copy.deepcopy(pick(rng, ODD_VALUES))
        elif isinstance(home, list):
            home.append(copy.deepcopy(value))
        else:
            table[str(key)] = copy.deepcopy(value)
    return table


def mutated_bytes(content: bytes, rng: Rng) -> bytes:
    """Cut, flipped, inserted, repeated or exchanged bytes and lines."""
    for _ in range(_changes(rng)):
        size = len(content)
        if size < 2:
            return content
        at, until = sorted(int(n) for n in rng.integers(0, size, 2))
        lines = content.split(b"\n")
        match int(rng.integers(7)):
            case 0:
                content = content[:at]
            case 1:
                content = content[:at] + bytes([int(rng.integers(256))]) + content[at + 1 :]
            case 2:
                content = content[:at] + rng.bytes(int(rng.integers(1, 20))) + content[at:]
            case 3:
                content = content[:at] + content[min(until, at + 200) :]
            case 4 if len(lines) > 1:
                del lines[int(rng.integers(len(lines)))]
                content = b"\n".join(lines)
            case 5 if len(lines) > 1:
                lines.insert(int(rng.integers(len(lines))), pick(rng, lines))
                content = b"\n".join(lines)
            case _:
                digit = pick(rng, b"0123456789.,-e\"'[]")
                content = content[:at] + bytes([digit]) + content[at + 1 :]
    return content


def mutated_archive(content: bytes, rng: Rng) -> bytes:
    """A numpy archive with one array scaled, cut, of other numbers, or missing."""
    with np.load(io.BytesIO(content), allow_pickle=False) as archive:
        arrays = {name: archive[name] for name in archive.files}
    name = pick(rng, arrays)
    array = arrays[name]
    kind = rng.random()
    if kind < 0.15:
        del arrays[name]
    elif kind < 0.3 and array.size > 1:
        arrays[name] = array[:-1]
    elif array.dtype.kind == "f":
        changed = np.array(array)
        flat = changed.reshape(-1)
        if kind < 0.7:
            flat[int(rng.integers(len(flat)))] *= pick(rng, FACTORS)
        elif kind < 0.9:
            flat *= pick(rng, FACTORS)
        else:
            flat[int(rng.integers(len(flat)))] = pick(rng, (np.nan, np.inf, 0.0, -1.0, 1e30))
        arrays[name] = changed
    elif array.dtype.kind in "iub" and array.size:
        flat = np.array(array).reshape(-1)
        at = int(rng.integers(len(flat)))
        flat[at] = not flat[at] if array.dtype.kind == "b" else int(rng.integers(0, 100))
        arrays[name] = flat.reshape(array.shape)
    stream = io.BytesIO()
    np.savez(stream, allow_pickle=False, **arrays)
    return stream.getvalue()


def mutated_cells(text: str, rng: Rng) -> str:
    """A CSV table with other cells, or cells in other rows."""
    rows = [line.split(",") for line in text.strip().split("\n")]
    for _ in range(_changes(rng)):
        row = int(rng.integers(0 if rng.random() < 0.1 else 1, len(rows)))
        column = int(rng.integers(len(rows[row])))
        cell = rows[row][column]
        try:
            number = float(cell)
        except ValueError:
            number = None
        if number is not None and rng.random() < 0.6:
            rows[row][column] = f"{number * pick(rng, FACTORS):g}"
        else:
            rows[row][column] = str(pick(rng, ("", "flat", "nan", "-", "1e9", "7,5", "x", cell + cell, "0")))
    if rng.random() < 0.2:
        rows.insert(1, list(pick(rng, rows)))
    return "\n".join(map(",".join, rows)) + "\n"


def json_text(table: dict[str, Any]) -> str:
    """The JSON of a table; infinite numbers and nan become words that Python's JSON reader accepts."""
    return json.dumps(table, indent=1, ensure_ascii=False)
