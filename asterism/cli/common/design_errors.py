"""Errors about a design, with the name of its file."""

from __future__ import annotations

import re
from pathlib import Path

from asterism.equilibrium.errors import Error


def with_design_file(error: Error, file: Path) -> Error:
    """The error after the name of the file, if it is about a field of a design and names no file.

    >>> from asterism.homogenize.errors import LawError
    >>> print(with_design_file(LawError("rods.motif: is missing", field="rods.motif"), Path("leaf.toml")))
    leaf.toml: rods.motif: is missing
    >>> print(with_design_file(Error("--law: is for a new preview"), Path("leaf.toml")))
    --law: is for a new preview
    """
    from asterism.homogenize.errors import LawError
    from asterism.pattern.design.design import Design
    from asterism.pattern.design.errors import DesignError

    field = error.field if isinstance(error, DesignError | LawError) else ""
    if re.split(r"\W", field, maxsplit=1)[0] not in Design.model_fields or not str(error).startswith(field):
        return error
    if isinstance(error, DesignError):
        return error.within(file)
    assert isinstance(error, LawError)
    return type(error)(f"{file}: {error}", error.stars, error.place_mm, error.field)
