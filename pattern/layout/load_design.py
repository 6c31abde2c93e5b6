"""Reading a design file and checking that its sheet can be laid out."""

from __future__ import annotations

from pathlib import Path

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.files import read_table
from asterism.pattern.layout.print_layout import print_layout


def load_design(path: str | Path) -> Design:
    """Read a design from a TOML or JSON file and check its geometry.

    Parameters
    ----------
    path : file ending in .toml or .json. Pictures are looked up in its folder.

    Raises
    ------
    DesignError
        The file cannot be read, a section has a mistake, or the sheet cannot be laid out. The message names the file,
        the field and its value.
    """
    path = Path(path)
    design = Design.from_dict(read_table(path), path.parent, path)
    try:
        print_layout(design)
    except DesignError as error:
        raise error.within(path) from None
    return design
