"""One design of a sweep: its computation in a process of its own, the quantities of its row, and its cost."""

from __future__ import annotations

import functools
import hashlib
import pickle
from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from PIL import Image

from asterism import (
    discrete,
    draw,
    equilibrium,
    exact,
    fem,
    homogenize,
    pattern,
    previews,
    process,
    results,
    shape,
    sweeps,
    verification,
)
from asterism.draw.render import render
from asterism.draw.scene import drawn_size, scene, sheet_camera
from asterism.equilibrium.errors import Error
from asterism.exact.cost import Cost, exact_cost
from asterism.homogenize.campaign.kept_samples import Outcome, attempt, sources_hash
from asterism.homogenize.errors import UnreadableLaw
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.design.entries import with_entries
from asterism.pattern.design.files import file_identity
from asterism.pattern.layout.build import layout
from asterism.results.words import doubts
from asterism.shape.shape import Shape
from asterism.sweeps.parameters import SweepParameter

CellValue = float | int | bool | str | None


@dataclass(frozen=True)
class Quantity:
    """A column of the table.

    Attributes
    ----------
    name : name of the column.
    unit : unit; empty for counts, ratios and texts.
    label : its words on the page.
    of : gives the value from the summary of a shape; None if the summary lacks it.
    """

    name: str
    unit: str
    label: str
    of: Callable[[Mapping[str, Any]], CellValue]


def _key(name: str, unit: str, label: str) -> Quantity:
    return Quantity(name, unit, label, lambda summary: summary.get(name))


def _extent(axis: int, name: str) -> Quantity:
    return Quantity(f"extent_{name}_mm", "mm", f"extent along {name}", lambda summary: summary["extent_mm"][axis])


def quantities(exact: bool) -> tuple[Quantity, ...]:
    """The columns after the parameters, of exact shapes or of previews."""
    of_both = (
        _key("height_mm", "mm", "height"),
        _key("above_needles_mm", "mm", "rise over the needles"),
        _key("below_needles_mm", "mm", "depth below the needles"),
        *(_extent(axis, name) for axis, name in enumerate("xyz")),
        _key("contraction", "", "contraction"),
        _key("roll_radius_mm", "mm", "radius of the roll"),
        _key("roll_axis_deg", "deg", "axis of the roll"),
        _key("energy_n_mm", "N mm", "energy"),
        _key("is_minimum", "", "certified equilibrium"),
        _key("self_intersections", "", "self-intersections"),
    )
    of_preview = (
        _key("expected_rms_percent", "% of the diameter", "estimated error"),
        _key("expected_height_percent", "% of the height", "estimated error of the height"),
        Quantity("stars_outside_law", "", "stars outside the law", lambda summary: len(summary["stars_outside_law"])),
    )
    of_exact = (
        Quantity("minima", "", "minima", lambda summary: len(summary["minima"])),
        _key("stars_up", "", "stars up"),
        _key("smallest_eigenvalue", "N/mm", "smallest eigenvalue"),
        _key("mesh_error_percent", "% of the diameter", "mesh error"),
        _key("mesh_change_percent", "% of the diameter", "change from the coarser mesh"),
    )
    words = (
        Quantity("not_reliable", "", "not reliable", lambda summary: "; ".join(doubts(summary)) or None),
        Quantity("warnings", "", "warnings", lambda summary: "; ".join(summary["warnings"]) or None),
    )
    return (*of_both, *(of_exact if exact else of_preview), *words)


def table_values(summary: Mapping[str, Any], exact: bool) -> dict[str, CellValue]:
    """The values of a shape by column; numbers have six digits: libraries on other machines differ in later ones."""
    values = {each.name: each.of(summary) for each in quantities(exact)}
    return {n: float(f"{v:.6g}") if isinstance(v, float) else v for n, v in values.items()}


# `webp`, a picture with a transparent background as text in base 64; `width_px`, `height_px`; and `px_per_mm`, its
# scale in the plane through the middle of the sheet
SmallPicture = dict[str, Any]


def small_picture(shape: Shape) -> SmallPicture:
    """The perspective view of a shape, as large as the limits allow."""
    shape = shape if shape.held else shape.aligned()
    thing, view = scene(shape), sheet_camera("oblique", shape.positions)
    scale = float((np.array([320, 240]) / drawn_size(thing, view)).min())  # at most so many pixels
    pixels = np.clip(np.flipud(render(thing, view, scale)), 0.0, 1.0)
    image = Image.fromarray(np.rint(255.0 * pixels).astype(np.uint8))
    out = BytesIO()
    image.save(out, "WEBP", quality=85)
    webp = b64encode(out.getvalue()).decode()
    return {"webp": webp, "width_px": image.width, "height_px": image.height, "px_per_mm": scale}


@functools.cache
def sweep_code_version() -> str:
    """Hash of all code that computes a row of a sweep or its picture."""
    engines = (discrete, equilibrium, fem, homogenize, pattern)
    rooms = (draw, exact, previews, process, results, shape, sweeps, verification)
    return sources_hash({package: ("**/*.py",) for package in (*engines, *rooms)})


def solve_point(table: Mapping[str, Any], is_exact: bool, law: bytes | None, code: str) -> Outcome:
    """Compute one design: the sample holds `values`, see `table_values`, and `picture`, a `SmallPicture`.

    Parameters
    ----------
    is_exact : by the exact model from both starts, as `simulate`, not by the preview.
    law : law of the preview, pickled; None for that of the design or the paper's.
    code : `sweep_code_version` of the process that asks.
    """

    def solve() -> dict[str, Any]:
        if code != sweep_code_version():
            raise RuntimeError("the worker has another version of asterism")
        design = Design.from_dict(table)
        if is_exact:
            from asterism.verification.simulate import simulate  # its imports take seconds

            found = simulate(design)
        else:
            from asterism.previews.session import preview

            found = preview(design, None if law is None else _law(law))
        return {"values": table_values(found.summary, is_exact), "picture": small_picture(found)}

    return attempt(solve, Error, ValueError, surroundings=(UnreadableLaw,))


@functools.lru_cache(maxsize=2)
def _law(packed: bytes) -> Law[Any]:
    """A law that travelled with its designs, unpacked once in each process."""
    law: Law[Any] = pickle.loads(packed)
    return law


def named_law(table: Mapping[str, Any]) -> str | None:
    """Hash of the law file that a design names, None without a readable one.

    If the file changes, shapes are computed again.
    """
    path = (table.get("material") or {}).get("law")
    if path is None or not Path(path).is_file():
        return None
    try:
        return _file_hash(path, file_identity(path))
    except OSError:
        return None


@functools.lru_cache(maxsize=64)
def _file_hash(path: str, identity: tuple[int, ...]) -> str:
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()[:16]


# processor time of a preview of a motif without its cells (0.26 s to 1.1 s), and of one cell with edges of 2 mm (the
# four motifs of asterism new: 0.5 s to 1.6 s in motif_responses)
MOTIF_PREVIEW_S = 0.6
MOTIF_CELL_S = 0.9
# a process imports its libraries
START_S = 3.0


@dataclass(frozen=True)
class SweepCost(Cost):
    """An estimate for so many designs; `vertices` of the largest exact shape, 0 for previews."""

    designs: int
    cheaper: ClassVar[str] = "fewer designs"

    def in_words(self) -> str:
        """One phrase.

        >>> SweepCost(0, 700.0, 11.0, 60).in_words(), SweepCost(4000, 800.0, 600.0, 60).in_words()
        ('60 previews, 0.7 GB, 11 s', '60 exact shapes of up to 4000 vertices, 0.8 GB, 10 min')
        """
        what = f"exact shapes of up to {self.vertices} vertices" if self.vertices else "previews"
        return f"{self.designs} {what}, {self.memory_mb / 1000:.1f} GB, {self.time_in_words}"


def sweep_cost(
    design: Design,
    parameters: Sequence[SweepParameter],
    count: int,
    exact: bool,
    processes: int,
    law_is_given: bool = False,
) -> SweepCost:
    """The cost of so many designs on so many processes; of exact shapes by the largest at the ends of parameters."""
    processes = min(processes, count)
    if not exact:
        # processor time of a preview with its picture, and memory of its process: all stars of the gallery with three
        # thicknesses each (0.06 s to 0.3 s of 37 stars, 0.3 s to 1.6 s of 85 to 127)
        each = 0.05 + 0.004 * _stars(design) if design.rods is None else MOTIF_PREVIEW_S
        # sheets on supports may buckle, and are searched for further forms
        each *= 2.0 if design.pins else 1.0
        if design.rods is not None and not law_is_given and design.law_file is None:
            # the preview solves the cells of its motif
            each += MOTIF_CELL_S * _motif_cells(design)
        return SweepCost(0, 350.0 * processes, START_S + each * count / processes, count)
    largest = max(map(exact_cost, _ends(design, parameters)), key=lambda cost: cost.seconds)
    seconds = START_S + largest.seconds * count / processes
    return SweepCost(largest.vertices, largest.memory_mb * processes, seconds, count)


def _stars(design: Design) -> int:
    """Number of stars; 0 if the design that is varied cannot be laid out itself."""
    try:
        return len(layout(design).centres)
    except Error:
        return 0


def _motif_cells(design: Design) -> int:
    """Number of cells of a preview's law; 1 if the design that is varied has no law itself."""
    from asterism.homogenize.campaign.design_plan import plan_for_design  # it loads the exact model

    try:
        plan, sheet = plan_for_design(design), layout(design)
        return len(plan.tasks_for_sizes(plan.sizes_on(design, sheet)))
    except Error:
        return 1


def _ends(design: Design, parameters: Sequence[SweepParameter]) -> list[Design]:
    """The design, and variants with the first or the last value of one parameter, as far as they are possible."""
    table, ends = design.to_dict(), [design]
    for parameter in parameters:
        values: Sequence[Any] = parameter.limits or parameter.values
        for value in (values[0], values[-1]):
            try:
                one = Design.from_dict(with_entries(table, {parameter.path: value}))
                exact_cost(one)
            except Error:
                continue
            ends.append(one)
    return ends
