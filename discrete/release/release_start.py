"""The start of a release: bumps of the stars, bend of the sheet, noise, and the steps of the release."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil
from typing import Literal, get_args

import numpy as np

from asterism.discrete.model.discrete_model import DiscreteModel, add_bumps, bump_heights
from asterism.discrete.model.state import State
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM

SheetBend = Literal["none", "roll", "dome", "saddle"]

# lengths are at the paper's spacing of the stars, and in proportion at others (`spacing_ratio`)
START_BUMP_MM = 2.0  # mm, height of the bump at every star
MIN_BRANCH_BUMP_MM = 0.1  # mm, height below which a star counts as flat between two steps
# released parts of the stretch, step by step: gradual (the default), at once (which reaches other minima), in two steps
GRADUAL_RELEASE = tuple(np.linspace(0.03, 1.0, 10))
GRADUAL_STRETCH = 1.35  # the largest one for these steps; more of it takes more steps
SUDDEN_RELEASE = (1.0,)
TWO_STEP_RELEASE = (0.3, 1.0)


@dataclass(frozen=True)
class ReleaseStart:
    """One start of a release.

    Raises `ValueError` if the releases do not grow from 0 to 1, the bend has no such name or no sag, or a branch is not
    -1, 0 or 1.

    >>> ReleaseStart(bend="roll", axis_deg=45.0, sag_mm=12.0, releases=SUDDEN_RELEASE).name
    'default'
    >>> ReleaseStart(bend="dome")
    Traceback (most recent call last):
    ValueError: sag_mm = 0.0: a bend needs one above 0
    """

    name: str = "default"  # shown in reports
    bumps: bool = True  # every star starts with a bump to the side of its branch; otherwise flat
    # 1 up, -1 down or 0 free, for each star; None takes the branches of the layout.
    branch: tuple[int, ...] | None = None
    bend: SheetBend = "none"  # shape of the whole sheet: flat, rolled about an axis, a dome, or a saddle
    # deg, direction of the axis of the roll or of the ridge of the saddle, in printed coordinates.
    axis_deg: float = 0.0
    # mm, sag of the outermost point below the centre (of a saddle: below and above), at the paper's spacing.
    sag_mm: float = 0.0
    noise_mm: float = 1e-3  # mm, standard deviation of the noise at every vertex, at the paper's spacing
    seed: int = 0  # seed of the noise
    releases: tuple[float, ...] = GRADUAL_RELEASE  # releases of the continuation; the last is 1

    def __post_init__(self) -> None:
        steps = (0.0, *self.releases)
        if len(steps) < 2 or steps[-1] != 1.0 or not all(a <= b for a, b in pairwise(steps)):
            raise ValueError(f"releases = {self.releases}: must grow from 0 or more, and the last must be 1")
        if self.branch is not None and not {*self.branch} <= {-1, 0, 1}:
            raise ValueError(f"branch = {self.branch}: must be 1 up, -1 down or 0 free for each star")
        if self.bend not in get_args(SheetBend):
            raise ValueError(f"bend = {self.bend!r}: must be one of {', '.join(get_args(SheetBend))}")
        if self.bend != "none" and not self.sag_mm > 0.0:
            raise ValueError(f"sag_mm = {self.sag_mm}: a bend needs one above 0")

    def branches(self, model: DiscreteModel) -> Array:
        """(S,) 1 up, -1 down or 0 free; ValueError if `branch` has not one entry for each star."""
        if not self.bumps:
            return np.zeros(len(model.layout.centres), dtype=np.int64)
        if self.branch is None:
            return model.layout.star_branch
        if len(self.branch) != len(model.layout.centres):
            raise ValueError(f"branch: must be of {len(model.layout.centres)} stars, not {len(self.branch)}")
        return np.asarray(self.branch)

    def initial_state(self, model: DiscreteModel) -> State:
        """The first state, at the present release of the model."""
        held, mm = model.constraints.held, spacing_ratio(model)
        # a sheet with most of its plastic below starts as the mirror image of one with it above
        facing = np.array([1.0, 1.0, -1.0 if model.edge_side.sum() < 0 else 1.0])
        if self.bend == "none":
            state = model.flat_state()
        else:
            # bend the print first, then move its pins, which may be far away
            bent = facing * _bent_sheet(model.mesh.points, self.bend, np.radians(self.axis_deg), mm * self.sag_mm)
            state = model.apply_supports(model.moved_to(model.printed_state(), bent))
        state = add_bumps(model, state, mm * START_BUMP_MM * self.branches(model))
        noise = facing * mm * self.noise_mm * np.random.default_rng(self.seed).standard_normal(state.positions.shape)
        return model.moved_to(state, state.positions + np.where(held, 0.0, noise))

    def restore_branches(self, model: DiscreteModel, state: State) -> State:
        """The state with all stars on the side of their branch.

        Early in the release a star is nearly flat, and rounding decides its side; a small bump is enough. An inverted
        star is no minimum before its arms are bent enough, so it is inverted again in every step.
        """
        mm = spacing_ratio(model)
        branch, height = self.branches(model), bump_heights(model, state) / mm
        # mm, the bump that a flat star gets
        lift = np.where(branch * height < MIN_BRANCH_BUMP_MM, 0.5 * branch, 0.0)
        lift = np.where((branch < 0) & (height > -MIN_BRANCH_BUMP_MM), -np.abs(height) - START_BUMP_MM, lift)
        if self.releases[-1] == model.release:
            lift = np.minimum(lift, 0.0)
        return model.reachable_state(state, add_bumps(model, state, mm * lift))


def spacing_ratio(model: DiscreteModel) -> float:
    """Spacing of the stars over that of the paper; lengths of a start scale with it."""
    return model.spacing / float(DEFAULT_SPACING_MM)


def start_of_design(design: Design) -> ReleaseStart:
    """The start that a design asks for. In longer steps, arms that keep their length would fold the fabric between."""
    stretch = max(design.fabric.stretch_xy)
    steps = max(len(GRADUAL_RELEASE), ceil(len(GRADUAL_RELEASE) * (stretch - 1.0) / (GRADUAL_STRETCH - 1.0)))
    releases = tuple(np.linspace(GRADUAL_RELEASE[0], 1.0, steps).tolist())
    return ReleaseStart(bumps=design.solver.start == "bump", seed=design.solver.seed, releases=releases)


def release_starts(n_stars: int, count: int, first: ReleaseStart) -> list[ReleaseStart]:
    """The first `count` starts of a fixed sequence.

    A gradual release ends in the same minimum from almost any start. Most other starts therefore release a bent sheet
    at once or in two steps.

    `first` is the first one; its seed is that of the sequence.

    >>> [start.name for start in release_starts(7, 4, ReleaseStart())]
    ['default', 'roll at 0 deg', 'roll at 90 deg', 'dome']
    """
    out, seed = [first], first.seed
    rng = np.random.default_rng([seed, n_stars])
    gradual = max(GRADUAL_RELEASE, first.releases, key=len)
    for k in range(count - 1):
        cycle, kind = divmod(k, 9)
        start = _start_of_cycle(kind, cycle, n_stars, rng, gradual)
        out.append(replace(start, seed=seed + 1 + k))
    return out


def _start_of_cycle(
    kind: int, cycle: int, n_stars: int, rng: np.random.Generator, gradual: tuple[float, ...]
) -> ReleaseStart:
    """One of the nine kinds of start; cycles differ in angle, sag and releases."""
    releases = SUDDEN_RELEASE if cycle % 2 == 0 else TWO_STEP_RELEASE
    # 0, 90, 45, 135, ... deg: every cycle halves the intervals
    angle = 180.0 * _van_der_corput(2 * cycle + kind % 2)
    sag = (20.0, 5.0, 12.0)[cycle % 3]
    match kind:
        case 0 | 1:
            return ReleaseStart(f"roll at {angle:.0f} deg", bend="roll", axis_deg=angle, sag_mm=sag, releases=releases)
        case 2:
            return ReleaseStart("dome", bend="dome", sag_mm=sag, releases=releases)
        case 3:
            return ReleaseStart(
                f"saddle at {angle:.0f} deg", bend="saddle", axis_deg=angle, sag_mm=sag, releases=releases
            )
        case 4:
            return ReleaseStart("sudden", releases=releases)
        case 5:
            return ReleaseStart("flat, sudden", bumps=False, releases=releases)
        case 6:
            return ReleaseStart("strong noise, gentle", noise_mm=0.3, releases=gradual)
        case 7 if n_stars:
            pattern = rng.choice([1, -1], n_stars, p=[0.8, 0.2])
            if pattern.min() > 0:
                pattern[0] = -1
            return ReleaseStart("random stars down", branch=tuple(int(b) for b in pattern))
        case _:
            return ReleaseStart(
                f"tight roll at {angle:.0f} deg", bend="roll", axis_deg=angle, sag_mm=2 * sag, releases=TWO_STEP_RELEASE
            )


def _bent_sheet(points: Array, bend: SheetBend, axis: float, sag: float) -> Array:
    """(V, 3) mm, the print (V, 2) laid on a cylinder or a quadric with the sag `sag` at its farthest point.

    The apex of the surface is above the centre of the sheet.
    """
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    points = points - middle
    along = points @ [np.cos(axis), np.sin(axis)]
    across = points @ [-np.sin(axis), np.cos(axis)]
    size = float(np.linalg.norm(points, axis=1).max())
    if bend == "roll":
        # half the angle of the arc, whose sag is size (1 - cos(angle))/angle, about size angle/2; a rolled sheet does
        # not meet itself
        angle = min(2.0 * sag / size, 2.5)
        u, z = size / angle * np.sin(across * angle / size), size / angle * (np.cos(across * angle / size) - 1.0)
        x = along * np.cos(axis) - u * np.sin(axis)
        y = along * np.sin(axis) + u * np.cos(axis)
        return np.column_stack([middle[0] + x, middle[1] + y, z])
    z = across**2 + along**2 if bend == "dome" else across**2 - along**2
    return np.column_stack([middle + points, -sag / size**2 * z])


def _van_der_corput(n: int) -> float:
    """Element n of van der Corput's sequence 0, 1/2, 1/4, 3/4, 1/8, ..., which is evenly spread at every length."""
    value, step = 0.0, 0.5
    while n:
        value += step * (n & 1)
        n, step = n >> 1, 0.5 * step
    return value
