"""The law of a motif as lines of text: its range, some of its values, its errors."""

from __future__ import annotations

from collections import Counter
from itertools import product

import numpy as np

from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.motif_table import MOTIF_QUANTITIES
from asterism.laws.directional_values import stretch_axes, values_along
from asterism.laws.motif_law_record import motif_law_record
from asterism.previews.law_warnings import MAX_HELD_OUT_ERROR_PERCENT
from asterism.process.count_line import without_numbers
from asterism.results.words import table_lines

# nodes of each size in the table of values, about
LISTED_NODES = 4
# characters of a label in the first lines
LABEL_COLUMN = 11
_HEADER = "lambda        angle  A along/across N/mm   D along/across N mm   curvature along/across 1/mm"


def motif_law_lines(law: MotifLaw) -> list[str]:
    """The law as lines of text."""
    head = table_lines(motif_law_record(law).table(), LABEL_COLUMN)
    doubts = motif_law_doubts(law)
    return [
        *head,
        "",
        *_values(law),
        *_errors(law),
        *([""] if doubts else []),
        *(f"  {each}" for each in doubts),
        *_problems(law),
    ]


def motif_law_doubts(law: MotifLaw) -> list[str]:
    """The reasons for which the law is not reliable: it misses its held-out cells."""
    errors = law.residuals["held_out"]["errors"]
    rms = {name: errors[name]["rms_percent"] for name in ("bending", "curvature") if name in errors}
    if max(rms.values(), default=0.0) <= MAX_HELD_OUT_ERROR_PERCENT:
        return []
    words = " and ".join(f"{percent:.0f} % in {name}" for name, percent in rms.items())
    return [f"the law's error at its held-out cells is {words} (rms): sizes that vary less make it smaller"]


def _values(law: MotifLaw) -> list[str]:
    """Principal stretches of the flat sheet, and stiffness and curvature along the smaller one and across."""
    names = [size.key.removesuffix("_mm") for size in law.plan.sizes]
    lines = [f"    {'   '.join(f'{name} mm' for name in names)}   {_HEADER}"]
    chosen = [nodes[:: max(1, (len(nodes) + 1) // LISTED_NODES)] for nodes in (size.nodes for size in law.plan.sizes)]
    for sizes in product(*chosen):
        tensors, _, inside = law.table(np.array([sizes]).reshape(1, len(sizes)))
        shown = "  ".join(f"{size:{len(name) + 3}.4g}" for name, size in zip(names, sizes, strict=True))
        if not inside[0]:
            lines.append(f"    {shown}   no law")
            continue
        axes = stretch_axes(tensors.metric)
        x, y = axes[0, 0]
        angle = round(float(np.degrees(np.arctan2(y, x)))) % 180
        values = values_along(tensors, axes)
        (smaller, larger), a, d, k = values.stretch[0], values.membrane[0], values.bending[0], values.curvature[0]
        lines.append(
            f"    {shown}   {smaller:.4f} {larger:.4f} {angle:3d} deg  {a[0]:8.4g} {a[1]:8.4g}     "
            f"{d[0]:8.4g} {d[1]:8.4g}     {k[0]:8.5f} {k[1]:8.5f}"
        )
    return lines


def _errors(law: MotifLaw) -> list[str]:
    held_out = law.residuals["held_out"]
    if not held_out["errors"]:
        return []
    lines = ["", f"  held out, {held_out['count']} cells; error in % of the cell's value"]
    lines.append(f"  {'':11} median    rms  largest")
    for name in MOTIF_QUANTITIES:
        e = held_out["errors"][name]
        lines.append(f"    {name:<10} {e['median_percent']:5.2f} {e['rms_percent']:6.2f} {e['largest_percent']:8.2f}")
    return lines


def _problems(law: MotifLaw) -> list[str]:
    """The reasons why cells have no law, without their numbers, and how often each occurs."""
    reasons = Counter(without_numbers(each["problem"]) for each in law.samples if each["problem"] is not None)
    lines = [f"    {count:4d}  {reason}" for reason, count in reasons.most_common()]
    return ["", "  cells without a law", *lines] if lines else []
