"""The computation of one design of a sweep, in a process of its own, and the quantities of its row."""

from __future__ import annotations

import functools
import hashlib
import pickle
from base64 import b64encode
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

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
from asterism.draw.render import OBLIQUE, VIEWER_DISTANCE, camera, render, scene
from asterism.equilibrium.errors import Error
from asterism.homogenize.campaign.kept_samples import Outcome, attempt, sources_hash
from asterism.homogenize.errors import UnreadableLaw
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.design.files import file_identity
from asterism.results.words import doubts
from asterism.shape.shape import Shape

# digits of the numbers in a table: libraries on other machines differ in later ones
TABLE_DIGITS = 6

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


_SHAPE = (
    _key("height_mm", "mm", "height"),
    _key("above_needles_mm", "mm", "rise over the needles"),
    _key("below_needles_mm", "mm", "depth below the needles"),
    _extent(0, "x"),
    _extent(1, "y"),
    _extent(2, "z"),
    _key("contraction", "", "contraction"),
    _key("roll_radius_mm", "mm", "radius of the roll"),
    _key("roll_axis_deg", "deg", "axis of the roll"),
    _key("energy_n_mm", "N mm", "energy"),
    _key("is_minimum", "", "certified equilibrium"),
    _key("self_intersections", "", "self-intersections"),
)
_PREVIEW = (
    _key("expected_rms_percent", "% of the diameter", "estimated error"),
    _key("expected_height_percent", "% of the height", "estimated error of the height"),
    Quantity("stars_outside_law", "", "stars outside the law", lambda summary: len(summary["stars_outside_law"])),
)
_EXACT = (
    Quantity("minima", "", "minima", lambda summary: len(summary["minima"])),
    _key("stars_up", "", "stars up"),
    _key("smallest_eigenvalue", "N/mm", "smallest eigenvalue"),
    _key("mesh_error_percent", "% of the diameter", "mesh error"),
    _key("mesh_change_percent", "% of the diameter", "change from the coarser mesh"),
)
_WORDS = (
    Quantity("not_reliable", "", "not reliable", lambda summary: "; ".join(doubts(summary)) or None),
    Quantity("warnings", "", "warnings", lambda summary: "; ".join(summary["warnings"]) or None),
)


def quantities(exact: bool) -> tuple[Quantity, ...]:
    """The columns after the parameters, of exact shapes or of previews."""
    return (*_SHAPE, *(_EXACT if exact else _PREVIEW), *_WORDS)


def table_values(summary: Mapping[str, Any], exact: bool) -> dict[str, CellValue]:
    """The values of a shape by column, with `TABLE_DIGITS` digits."""
    return {each.name: _rounded(each.of(summary)) for each in quantities(exact)}


def _rounded(value: CellValue) -> CellValue:
    return float(f"{value:.{TABLE_DIGITS}g}") if isinstance(value, float) else value


# `webp`, a picture with a transparent background as text in base 64; `width_px`, `height_px`; and `px_per_mm`, its
# scale in the plane through the middle of the sheet
SmallPicture = dict[str, Any]


def small_picture(shape: Shape) -> SmallPicture:
    """The perspective view of a shape, as large as the limits allow."""
    shape = shape if shape.held else shape.aligned()
    thing = scene(shape)
    low, high = shape.positions.min(axis=0), shape.positions.max(axis=0)
    view = camera(*OBLIQUE, (low + high) / 2, VIEWER_DISTANCE * float(np.linalg.norm(high - low)))
    size = np.maximum(np.ptp(view.project(thing.points)[:, :2], axis=0), 1e-3)
    scale = float((np.array([320, 240]) / size).min())  # at most so many pixels
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
            from asterism.verification.both_starts import simulate  # its imports take seconds

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
