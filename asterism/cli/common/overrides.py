"""Options that replace entries of the design."""

from __future__ import annotations

from typing import Any

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.print_layout import print_layout


def with_overrides(design: Design, options: dict[str, tuple[str, Any]]) -> Design:
    """The design with the entries given on the command line.

    Parameters
    ----------
    options : for each option its name, the dotted field of the design, and the value; None for no change.

    Raises
    ------
    DesignError
        A value is not allowed; the message names the option.
    """
    data = design.to_dict()
    given = {option: entry for option, entry in options.items() if entry[1] is not None}
    for field, value in given.values():
        section, key = field.split(".")
        data.setdefault(section, {})[key] = value
    if not given:
        return design
    try:
        new = Design.from_dict(data)
        print_layout(new)
    except DesignError as error:
        for option, (field, _) in given.items():
            if field == error.field:
                raise DesignError(option, error.allowed, error.value) from None
        raise
    return new
