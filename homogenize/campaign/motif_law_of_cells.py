"""The law of a design's own motif, from cells that are solved now."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from homogenize.campaign.campaign import CampaignProgress
from homogenize.campaign.fit_motif_law import fit_motif_law
from homogenize.campaign.motif_campaign import run_motif_campaign
from homogenize.campaign.motif_design_plan import plan_for_motif
from homogenize.law.motif_law import MotifLaw
from pattern.design.design import Design

# laws that are kept for the next call
MAX_KEPT_LAWS = 8
_kept: dict[str, MotifLaw] = {}


def solve_motif_law(
    design: Design,
    edge_mm: float | None = None,
    jobs: int = 1,
    report: Callable[[CampaignProgress], None] | None = None,
) -> MotifLaw:
    """Solve the cells of a design's motif and fit its law. Designs with the same cells get the same law at once.

    Parameters
    ----------
    edge_mm : of the cells' mesh; by default that of the design.
    jobs : processes of this machine.
    report : called at the beginning and after every cell.

    Raises
    ------
    DesignError
        There is no law of such a design.
    CampaignError
        The cells have no law; the message has the reason.
    """
    plan = plan_for_motif(design, edge_mm)
    data = plan.to_dict()
    data["design"].pop("name")
    key = json.dumps(data, sort_keys=True)
    if key in _kept:
        return _kept[key]
    with TemporaryDirectory() as folder:
        law = fit_motif_law(plan, run_motif_campaign(plan, Path(folder), jobs, None, report))
    while len(_kept) >= MAX_KEPT_LAWS:
        del _kept[next(iter(_kept))]
    _kept[key] = law
    return law
