"""The shape on the page of a design: from its results, or from a new preview."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from asterism.homogenize.law.any_law import AnyLaw
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.shape.read_shape import read_shape
from asterism.shape.shape import Shape


def shape_for_report(
    design: Design, results: Path | None, beside: Path | None, say: Callable[[str], None], law: AnyLaw | None = None
) -> tuple[Shape | None, str]:
    """Return a shape of the design and its origin; None and the reason if no preview is available.

    Parameters
    ----------
    results : directory of results, or its shape.vtu.
    beside : usual directory of the results. They are used if they belong to this design; a preview among them is
        ignored if a law is given.
    say : called with a line if the first run compiles loops, and if no shape is available.
    law : law of a new preview; that of the paper's material by default.

    Raises
    ------
    DesignError
        The results belong to another design, or cannot be read.
    """
    from asterism.homogenize.errors import ForeignLaw, LawError
    from asterism.homogenize.law.motif_plan import without_motif_law
    from asterism.previews.run import preview
    from asterism.process.compiling import announce_compiling

    if results is not None:
        shape = read_shape(results)
        if not _is_of(shape, design):
            raise DesignError("--results", "must be of this design; compute them again", str(results))
        return shape, shape.made_by
    if beside is not None and (beside / "shape.vtu").is_file():
        try:
            shape = read_shape(beside)
        except DesignError:
            pass  # unreadable results beside the design are ignored
        else:
            if _is_of(shape, design) and not (law is not None and shape.is_preview):
                return shape, shape.made_by
    if design.rods is not None and without_motif_law(design) is not None:
        say("the page has no picture: drawn lines that do not repeat have no preview; run asterism simulate first")
        return None, "not known: drawn lines that do not repeat have no preview"
    try:
        with announce_compiling(say):
            shape = preview(design, law)
    except LawError as error:
        give = "--law or --results" if isinstance(error, ForeignLaw) else "--results"
        say(f"the page has no picture: {error}; give {give}")
        return None, "not known: no law of this material and lattice"
    return shape, shape.made_by


def _is_of(shape: Shape, design: Design) -> bool:
    """Whether a shape belongs to this design; name, mesh and solver may differ."""
    made_from = shape.summary.get("design")
    try:
        other = None if made_from is None else Design.from_dict(made_from)
    except DesignError:
        return False
    aside = {name: getattr(design, name) for name in ("name", "mesh", "solver")}
    return other is not None and other.model_copy(update=aside) == design
