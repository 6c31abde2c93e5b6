"""Designs from files, with the measured material of another file in place of their own."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from asterism.homogenize.law.material import Material, load_material
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.material_files import material_path
from asterism.pattern.design.materials import ResidualCurvature
from asterism.pattern.layout.build import layout, load_design
from asterism.pattern.layout.free_motions import check_weight_is_supported


def material_in_words(path: Path) -> str:
    """One line on a material file: the plastic, the fabric, where the values come from and when they were measured.

    Raises DesignError: the file is not a material.

    >>> from asterism.pattern.design.material_files import material_files
    >>> material_in_words(material_files()["paper"]).split("; ")[0]
    'E1/E2 3200 (paper), kappa_bar 0 /mm'
    """
    material = load_material(path, plan_is_used=False)
    plastic, fabric, measured = material.plastic, material.fabric, material.measured
    kept = plastic.kappa_bar_per_mm
    bar = "by thickness" if isinstance(kept, ResidualCurvature) else f"{kept:.4g} /mm"
    at = f", at stretch {fabric.stretch_xy[0]:g}" if "stretch" in fabric.model_fields_set else ""
    modulus = f", E {fabric.modulus_text}" if fabric.has_scale else ""
    source = ", ".join(filter(None, (measured.source, measured.date))) if measured else "source not given"
    return (
        f"E1/E2 {plastic.modulus_ratio:.4g} ({plastic.rest_curvature}), kappa_bar {bar}; "
        f"fabric {fabric.thickness_mm:g} mm{at}{modulus}; {source}"
    )


Note = Callable[[str], None]


def read_design(path: Path, material: Path | None, note: Note) -> Design:
    """A design that is to be computed, from its file, with the material of another file.

    Raises DesignError: as `load_design` and `with_material`, or nothing carries the sheet's weight.
    """
    design = with_material(load_design(path), material, note)
    try:
        if design.gravity.on:
            check_weight_is_supported(design, layout(design))
    except DesignError as error:
        raise error.within(path) from None
    return design


def with_material(design: Design, path: Path | None, note: Note | None = None) -> Design:
    """The design with the fabric and plastic of a material, by its name or file; without one, the design itself.

    Only values that the file contains replace those of the design. The stretch of the file is that of the measurement:
    it is taken if the design gives none. The lattice of the design stays.

    `note`: called with a line for each value of the file that is not used, and if the file changes nothing.

    Raises DesignError: no material has the name, the file is not one, it has no value for the design, or the design
    does not fit it.
    """
    if path is None:
        return design
    path = material_path(path, "--material")
    material = load_material(path, plan_is_used=False)
    kept = {"stretch"} if "stretch" in design.fabric.model_fields_set else set()
    sections = {"fabric": material.fabric, "plastic": material.plastic, "spread": material.spread}
    given = {
        name: section.model_dump(mode="json", include=section.model_fields_set)
        for name, section in sections.items()
        if section is not None
    }
    if not any(given.values()):
        raise DesignError(
            "", "has no value in [fabric], [plastic] or [spread], so that --material would change nothing", file=path
        )
    data = design.to_dict()
    data.pop("material", None)  # its law belongs to the material that is replaced
    for name, values in given.items():
        data.setdefault(name, {}).update({key: value for key, value in values.items() if key not in kept})
    try:
        new = Design.from_dict(data)
    except DesignError as error:
        raise error.within(path) from None
    if note:
        for line in _unused(design, new, material):
            note(f"{path}: {line}")
    return new


def _unused(design: Design, new: Design, material: Material) -> Iterator[str]:
    """A line for each value of a material that a design does not take."""
    if (new.fabric, new.plastic, new.spread) == (design.fabric, design.plastic, design.spread):
        yield "its fabric and plastic are those of the design: --material changes nothing"
    measured = material.fabric.stretch_xy
    if "stretch" in material.fabric.model_fields_set and measured != new.fabric.stretch_xy:
        stretch = " x ".join(f"{part:g}" for part in dict.fromkeys(new.fabric.stretch_xy))
        yield f"it was measured at a stretch of {measured[0]:g}; the stretch of the design is used, {stretch}"
    if "lattice" in material.model_fields_set and material.lattice != design.lattice:
        spacings = f"{material.lattice.spacing_mm:.4g} mm, {design.lattice.spacing_mm:.4g} mm"
        yield f"its lattice is not used, but that of the design (spacings {spacings})"
