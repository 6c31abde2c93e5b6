"""Laws and designs: where the law of a design lies, which material and plan it has, and whether it fits."""

from __future__ import annotations

from pathlib import Path
from shlex import quote

from asterism.homogenize.campaign.design_plan import plan_for_sizes
from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.any_law import AnyLaw
from asterism.homogenize.law.axes import law_coordinates
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import load_law
from asterism.homogenize.law.material import PAPER_MATERIAL, Material, load_material
from asterism.homogenize.law.motif_law_file import is_motif_law, load_motif_law
from asterism.homogenize.universal.groups import MIN_FABRIC_TO_EDGE
from asterism.laws.replace_material import Note, with_material
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.files import read_table
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.load_design import load_design
from asterism.previews.law_choice import serving_law


def law_output_path(file: Path | None, output: Path | None, other: Path | None = None) -> Path:
    """Path for a new law: `output`, or beside the file; the paper's law goes into the working directory.

    Parameters
    ----------
    file : design or material; None for the paper's material.
    other : material file that replaces the design's material.
    """
    if output is not None or file is None:
        return output or Path("paper.npz")
    return design_law_path(file, other) if is_design(file) else file.with_suffix(".npz")


def design_law_path(design: Path, other: Path | None = None) -> Path:
    """Path for the law of a design's own stars. With another material the path has its name too."""
    of = "" if other is None else f"-{other.stem}"
    return design.with_name(f"{design.stem}-law{of}.npz")


def is_design(file: Path | None) -> bool:
    """Whether a file holds a design, whose pattern gives the plan, and not a material with its plan."""
    return file is not None and bool({"stars", "rods", "border"} & read_table(file).keys())


def material_from_file(file: Path | None, other: Path | None = None, note: Note | None = None) -> Material:
    """The material and plan in a file; of a design, its own material, and cells for its own stars.

    Parameters
    ----------
    file : the paper's material if there is none.
    other : a material's file, whose fabric and plastic take the place of the design's.
    note : as of `with_material`.

    Raises
    ------
    DesignError
        The file is wrong, or there is no law of its material.
    """
    if file is None or not is_design(file):
        if other is not None:
            raise DesignError("--material", "goes with a design, whose fabric and plastic it replaces", str(other))
        return load_material(file or PAPER_MATERIAL)
    design = with_material(load_design(file), other, note)
    try:
        return material_for_design(design)
    except DesignError as error:
        raise error.within(file) from None


def material_for_design(design: Design, edge_mm: float | None = None) -> Material:
    """The material of a design, with a plan of cells for its own stars (`plan_for_sizes`)."""
    return plan_for_sizes(design, law_coordinates(layout(design), design.lattice.arms), edge_mm)


def law_for_design(design: Design, law: Path | None, file: Path, other: Path | None = None) -> Law:
    """The law in a file, if it fits the design.

    Parameters
    ----------
    law : None for the law that the design names, or else the paper's, or else the universal law where it serves.
    file, other : files of the design and of the material that replaces its own; for the message.

    Raises
    ------
    LawError
        The file is not a law, or the law does not fit; the message names the command that makes one.
    """
    law = chosen_law_path(design, law)
    own_law = None if law is None else load_law(law)
    try:
        own_law = own_law or serving_law(design)
        own_law.check(design)
    except LawError as error:
        material = f" --material {quote(str(other))}" if other else ""
        refused = f"{file}{material}: {error}"
        if isinstance(error, ForeignLaw):
            refused += f" ({law})" if law else ""
            refused += "; without --law the package's own is taken" if law and _is_papers(design) else ""
            calibration = f"asterism calibrate {quote(str(file))}{material}"
            if is_too_thin(design):
                edge = design.fabric.thickness_mm / MIN_FABRIC_TO_EDGE
                refused += f"; the law of {calibration} would miss its cells, as so thin a fabric buckles in them: it "
                refused += f"takes a material's file with plan.edge_mm of at most {edge:.3g}"
            else:
                refused += f"; {calibration} makes its law, for --law {quote(str(design_law_path(file, other)))}"
        raise LawError(refused, error.stars, error.place_mm, error.field) from None
    return own_law


def any_law_for_design(design: Design, law: Path | None, file: Path, other: Path | None = None) -> AnyLaw | None:
    """The law of a preview, of stars (`law_for_design`) or of a motif; None for a motif whose cells the preview solves.

    Raises
    ------
    LawError
        The file is not a law, or the law does not fit; the message names the command that makes one.
    """
    path = chosen_law_path(design, law)
    if design.rods is None:
        return law_for_design(design, law, file, other)
    if path is None:
        return None
    if path.is_file() and not is_motif_law(path):
        raise ForeignLaw(f"{file}: {path}: is a law of stars, not of the motif of drawn rods", field="rods.motif")
    own = load_motif_law(path)
    try:
        own.check(design)
    except LawError as error:
        refused = f"{file}: {error}"
        if isinstance(error, ForeignLaw):
            material = f" --material {quote(str(other))}" if other else ""
            refused += f" ({path}); asterism calibrate {quote(str(file))}{material} makes its law"
            refused += f", for --law {quote(str(design_law_path(file, other)))}"
        raise type(error)(refused, field=error.field) from None
    return own


def is_too_thin(design: Design) -> bool:
    """Whether the fabric buckles between the stars as the mesh of its own law's cells lets it, so that the law misses.

    See docs/explanation/unit-cells.md, thin fabrics.
    """
    try:
        edge = material_for_design(design).plan.edge_mm
    except DesignError:  # it has no law of its own
        return False
    return design.fabric.thickness_mm < MIN_FABRIC_TO_EDGE * edge


def chosen_law_path(design: Design, law: Path | None) -> Path | None:
    """The file of the law: the one given, or else that of the section `[material]`; None for the paper's law."""
    return law if law is not None or design.law_file is None else Path(design.law_file)


def _is_papers(design: Design) -> bool:
    """Whether the paper's law fits the design."""
    try:
        load_law().check(design)
    except ForeignLaw:
        return False
    return True
