"""Every field of a sample is documented, arrays with the shape that they have."""

from __future__ import annotations

import re
from dataclasses import fields

from asterism.homogenize.cell.sample import Sample


def test_every_field_has_a_line() -> None:
    names = [
        name
        for line in re.findall(r"^    ([\w, ]+) : ", Sample.__doc__ or "", re.MULTILINE)
        for name in line.split(", ")
    ]
    assert sorted(names) == sorted(field.name for field in fields(Sample))
    arrays = [field.name for field in fields(Sample) if "Array" in str(field.type)]
    for name in arrays:
        line = re.search(rf"^    [\w, ]*\b{name}\b[\w, ]* : (.*)$", Sample.__doc__ or "", re.MULTILINE)
        assert line and line[1].startswith("("), name
