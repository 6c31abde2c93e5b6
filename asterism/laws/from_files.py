"""Designs, materials and laws from files: a measured material in place of a design's own, and the law that fits it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from asterism.homogenize.campaign.design_plan import plan_for_design
from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import load_law
from asterism.homogenize.law.material import PAPER_MATERIAL, Material, load_material
from asterism.homogenize.law.plan import LawPlan
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.files import read_table
from asterism.pattern.design.material_files import material_path
from asterism.pattern.design.materials import ResidualCurvature
from asterism.pattern.layout.build import layout, load_design
from asterism.pattern.layout.free_motions import check_weight_is_supported
from asterism.process.environment import quoted


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


def law_output_path(file: Path | None, output: Path | None, other: Path | None) -> Path:
    """Path for a new law: `output`, or beside the file; the paper's law goes into the working directory.

    `file`: design or material; None for the paper's material; `other`: material file that replaces the design's
    material.
    """
    if output is not None or file is None:
        return output or Path("paper.npz")
    of = "" if other is None else f"-{other.stem}"
    return file.with_name(f"{file.stem}-law{of}.npz") if is_design(file) else file.with_suffix(".npz")


def is_design(file: Path | None) -> bool:
    """Whether a file holds a design, whose pattern gives the plan, and not a material with its plan."""
    return file is not None and bool({"stars", "rods", "border"} & read_table(file).keys())


def plan_from_file(file: Path | None, other: Path | None, note: Note) -> LawPlan:
    """The cells of the law of a material, or of the stars or the motif of a design.

    `file`: the paper's material if there is none; `other`: a material's file, whose fabric and plastic take the place
    of the design's; `note`: as of `with_material`.

    Raises DesignError: the file is wrong, or there is no law of its material or pattern.
    """
    if file is None or not is_design(file):
        if other is not None:
            raise DesignError("--material", "goes with a design, whose fabric and plastic it replaces", str(other))
        return load_material(file or PAPER_MATERIAL).law_plan()
    design = with_material(load_design(file), other, note)
    try:
        return plan_for_design(design)
    except DesignError as error:
        raise error.within(file) from None


def law_from_file(design: Design, law: Path | None, file: Path, other: Path | None = None) -> Law[Any] | None:
    """The law in a file, if it fits the design; None without a file, so that the preview chooses or makes its law.

    `law`: None for the law that the design names; `file`, `other`: files of the design and of the material that
    replaces its own; for the message.

    Raises LawError: the file is not a law, or the law does not fit.
    """
    path = law if law is not None or design.law_file is None else Path(design.law_file)
    if path is None:
        return None
    own = load_law(path)
    try:
        own.check(design)
    except LawError as error:
        refused = f"{file}: {error}"
        if isinstance(error, ForeignLaw):
            material = f" --material {quoted(other)}" if other else ""
            refused += f" ({path}); without it the preview makes its own law{material and ' of' + material}"
        raise type(error)(refused, error.stars, error.place_mm, error.field) from None
    return own
