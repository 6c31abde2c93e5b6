"""The text of an edited design file: tables that were not changed keep their lines, comments included."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from asterism.pattern.design.files import table_text

_HEADER = re.compile(r"^\s*\[{1,2}\s*([\w.-]+)\s*\]{1,2}\s*(#.*)?$")
_FORMAT = Path("design.toml")


@dataclass
class _Block:
    """Lines of a file that belong together: one table, or all tables of one list.

    Attributes
    ----------
    name : dotted header, as `stars.override`; empty for the lines before the first header.
    comment, text : the lines of comments above the header, and the rest.
    """

    name: str
    comment: str
    text: str


def edited_text(text: str, table: Mapping[str, Any]) -> str:
    """The text of a table that was made from a file by edits.

    Tables that hold the same as in the file keep their lines. A table that holds something else is written anew, under
    the comment above its header. Lists of tables, as `[[pins]]`, count as one table.

    Parameters
    ----------
    text : of the file in TOML.
    table : what the new text must hold.

    Examples
    --------
    >>> print(edited_text("# mine\\n[stars]\\nlength_mm = 9.0 # long\\n\\n[border]\\nrings = 2 # small\\n",
    ...                   {"stars": {"length_mm": 9.0}, "border": {"rings": 3}}))
    # mine
    [stars]
    length_mm = 9.0 # long
    <BLANKLINE>
    [border]
    rings = 3
    <BLANKLINE>
    """
    whole = table_text(dict(table), _FORMAT)
    try:
        old, new = _blocks(text), _blocks(whole)
        kept = "".join(_merged(old, new))
        return kept if tomllib.loads(kept) == tomllib.loads(whole) else whole
    except ValueError:
        return whole


def _blocks(text: str) -> dict[str, _Block]:
    """The blocks of a text by name, in their order; tables of one list need not stand together."""
    blocks = {"": _Block("", "", "")}
    block, waiting = blocks[""], ""
    for line in text.splitlines(keepends=True):
        header = _HEADER.match(line)
        if header:
            name = header[1]
            if name in blocks:
                block = blocks[name]
                block.text += waiting + line
            else:
                block = blocks[name] = _Block(name, waiting, line)
            waiting = ""
        elif not line.strip() or line.lstrip().startswith("#"):
            waiting += line  # belongs to the header that follows, if one follows
        else:
            block.text += waiting + line
            waiting = ""
    block.text += waiting
    return blocks


def _merged(old: dict[str, _Block], new: dict[str, _Block]) -> list[str]:
    """The old blocks where they hold the same as the new ones, else the new ones in the place of the old."""
    order = [name for name in old if name in new or not name]
    for name in new:
        if name not in order:
            relatives = [k for k, other in enumerate(order) if other.split(".")[0] == name.split(".")[0]]
            order.insert(relatives[-1] + 1 if relatives else len(order), name)
    parts: list[str] = []
    for name in order:
        before, after = old.get(name), new.get(name, _Block(name, "", ""))
        if before is None:
            part = after.comment + after.text
        elif tomllib.loads(before.text) == tomllib.loads(after.text):
            part = before.comment + before.text
        else:
            part = before.comment + after.text
        if part.strip():
            parts.append(part if part.endswith("\n") else f"{part}\n")
    return [
        part if not k or part.startswith("\n") or parts[k - 1].endswith("\n\n") else f"\n{part}"
        for k, part in enumerate(parts)
    ]
