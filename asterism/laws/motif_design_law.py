"""The law of a design whose pattern is a motif: from its file, or from cells that are solved now."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from shlex import quote

from asterism.laws.design_law import chosen_law_path, design_law_path
from homogenize.campaign.campaign import CampaignProgress
from homogenize.campaign.motif_law_of_cells import solve_motif_law
from homogenize.errors import ForeignLaw, LawError
from homogenize.law.motif_law import MotifLaw
from homogenize.law.motif_law_file import load_motif_law
from pattern.design.design import Design


def motif_law_for_design(
    design: Design,
    law: Path | None = None,
    file: Path | None = None,
    other: Path | None = None,
    jobs: int = 1,
    report: Callable[[CampaignProgress], None] | None = None,
) -> MotifLaw:
    """The law in a file, if it fits the design; without a file the design's cells are solved.

    Parameters
    ----------
    law : None for the law that the design names; of designs that name none, the cells are solved.
    file, other : files of the design and of the material that replaces its own; for messages.
    jobs : processes of this machine for the cells.
    report : called at the beginning and after every cell.

    Raises
    ------
    DesignError
        There is no law of such a design.
    LawError
        The file is not the law of a motif, or does not fit; the message names the command that makes one.
    CampaignError
        The cells have no law; the message has the reason.
    """
    path = chosen_law_path(design, law)
    if path is None:
        return solve_motif_law(design, jobs=jobs, report=report)
    own = load_motif_law(path)
    try:
        own.check(design)
    except LawError as error:
        refused = str(error) if file is None else f"{file}: {error}"
        if isinstance(error, ForeignLaw):
            material = f" --material {quote(str(other))}" if other else ""
            refused += f" ({path})"
            if file is not None:
                refused += f"; asterism calibrate {quote(str(file))}{material} makes its law"
                refused += f", for --law {quote(str(design_law_path(file, other)))}"
        raise type(error)(refused, field=error.field) from None
    return own
