"""Designs from files, with the measured material of another file in place of their own."""

from __future__ import annotations

from pathlib import Path

from homogenize.law.material import load_material
from pattern.design.design import Design
from pattern.design.errors import DesignError
from pattern.layout.build import layout
from pattern.layout.load_design import load_design
from pattern.layout.weight_support import check_weight_is_supported


def read_design(path: Path, material: Path | None) -> Design:
    """A design that is to be computed, from its file, with the material of another file.

    Raises
    ------
    DesignError
        As `load_design` and `with_material`, or nothing carries the sheet's weight.
    """
    design = with_material(load_design(path), material)
    try:
        if design.gravity.on:
            check_weight_is_supported(design, layout(design))
    except DesignError as error:
        raise error.within(path) from None
    return design


def with_material(design: Design, path: Path | None) -> Design:
    """The design with the fabric and plastic of a material file; without a file, the design itself.

    Only values that the file contains replace those of the design. The stretch stays that of the design: the stretch in
    the file is that of the measurement.

    Raises
    ------
    DesignError
        The file is not a material, or the design does not fit it.
    """
    if path is None:
        return design
    material = load_material(path)
    data = design.to_dict()
    for name in ("fabric", "plastic"):
        section = getattr(material, name)
        said = section.model_dump(mode="json", include=section.model_fields_set - {"stretch"})
        data.setdefault(name, {}).update(said)
    try:
        return Design.from_dict(data)
    except DesignError as error:
        raise error.within(path) from None
