"""Laws and designs: where the law of a design lies, which cells it has, and whether it fits."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from asterism.homogenize.campaign.design_plan import plan_for_design
from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import load_law
from asterism.homogenize.law.material import PAPER_MATERIAL, load_material
from asterism.homogenize.law.plan import LawPlan
from asterism.laws.replace_material import Note, with_material
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.files import read_table
from asterism.pattern.layout.build import load_design
from asterism.process.environment import quoted


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
