"""The computation of one design of a sweep, in a process of its own."""

from __future__ import annotations

import functools
import hashlib
import pickle
from base64 import b64encode
from collections.abc import Mapping
from dataclasses import asdict, dataclass
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
from asterism.process.file_identity import file_identity
from asterism.shape.shape import Shape
from asterism.sweeps.quantities import table_values


@dataclass(frozen=True)
class SmallPicture:
    """A picture as WEBP with a transparent background.

    Attributes
    ----------
    webp : text in base 64.
    width_px, height_px : size.
    px_per_mm : scale in the plane through the middle of the sheet.
    """

    webp: str
    width_px: int
    height_px: int
    px_per_mm: float


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
    return SmallPicture(b64encode(out.getvalue()).decode(), image.width, image.height, scale)


@functools.cache
def sweep_code_version() -> str:
    """Hash of all code that computes a row of a sweep or its picture."""
    engines = (discrete, equilibrium, fem, homogenize, pattern)
    rooms = (draw, exact, previews, process, results, shape, sweeps, verification)
    return sources_hash({package: ("**/*.py",) for package in (*engines, *rooms)})


def solve_point(table: Mapping[str, Any], is_exact: bool, law: bytes | None, code: str) -> Outcome:
    """Compute one design.

    Parameters
    ----------
    table : the design as plain data.
    is_exact : by the exact model from both starts, as `simulate`, not by the preview.
    law : law of the preview, from `packed_law`.
    code : `sweep_code_version` of the process that asks.

    Returns
    -------
    Its sample holds `values`, see `table_values`, and `picture`, the attributes of a `SmallPicture`.
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
        return {"values": table_values(found.summary, is_exact), "picture": asdict(small_picture(found))}

    return attempt(solve, Error, ValueError, surroundings=(UnreadableLaw,))


@functools.lru_cache(maxsize=2)
def _law(packed: bytes) -> Law[Any]:
    """A law that travelled with its designs, unpacked once in each process."""
    law: Law[Any] = pickle.loads(packed)
    return law


def packed_law(law: Law[Any] | None) -> bytes | None:
    """A law on its way to the workers; None for that of the design or the paper's, which they read."""
    return None if law is None else pickle.dumps(law)


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
