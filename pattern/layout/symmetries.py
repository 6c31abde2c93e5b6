"""Turns and mirrors of the print that map the whole design onto itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from pattern.design.design import Design
from pattern.geometry.arrays import Floats, Ints
from pattern.geometry.planar import STRAIGHT, turns
from pattern.layout.layout import Layout
from pattern.layout.pin_places import pin_places

NEAR = 1e-6  # of the spacing, or of a size: equal but for rounding


@dataclass(frozen=True)
class Symmetry:
    """A motion `p -> turn p + shift` of the print after which everything is where something equal was.

    Attributes
    ----------
    turn : (2, 2) orthogonal; a mirror if its determinant is -1.
    shift : (2,) mm.
    star : (S,) the star onto which each star is moved.

    Notes
    -----
    If `x(p)` is an equilibrium, so is the shape `x'(p) = Q x(turn p + shift)`, with Q any proper rotation if `turn` is
    one. A mirrored print has its plastic on the wrong side, so there Q must be improper: the shape is reflected in
    space too, which no energy notices.
    """

    turn: Floats
    shift: Floats
    star: Ints

    @property
    def mirrors(self) -> bool:
        """Whether it is a mirror, and not a rotation."""
        return bool(np.linalg.det(self.turn) < 0.0)


def symmetries(design: Design, layout: Layout) -> list[Symmetry]:
    """All symmetries of the stars, their arms and sizes, the border, the pins, the stretch and the weight.

    The identity comes first. Every one maps the centre of the stars to itself, and the lattice onto itself but for a
    shift.
    """
    near = NEAR * layout.spacing_mm
    centre = layout.centres.mean(axis=0)
    # tips may meet: a quarter of the way back to the centre no two arms do
    inner = cKDTree(layout.arm_tip + 0.25 * (layout.centres[layout.arm_star] - layout.arm_tip))
    # corners on a side change nothing
    border = layout.border[np.abs(turns(layout.border)) > STRAIGHT]
    stars, corners, pins = cKDTree(layout.centres), cKDTree(border), pin_places(layout)
    found = []
    for turn in _candidates(layout.lattice_vectors):
        shift = centre - turn @ centre
        star = _image(layout.centres @ turn.T + shift, stars, near)
        if star is None or not _keeps_directions(design, turn):
            continue
        if not _same_sides(_image(border @ turn.T + shift, corners, near)):
            continue
        if _same_arms(layout, inner, turn, shift, star, near) and _same_pins(pins, turn, shift, near):
            found.append(Symmetry(turn, shift, star))
    return found


def _candidates(vectors: Floats) -> list[Floats]:
    """Orthogonal matrices that map the lattice onto itself, the identity first."""
    steps = np.stack(np.meshgrid(*2 * [np.arange(-3, 4)], indexing="ij"), axis=-1).reshape(-1, 2) @ vectors
    angle = np.arctan2(*vectors[0][::-1])
    length = np.linalg.norm(steps, axis=1)
    same = steps[np.abs(length - np.linalg.norm(vectors[0])) < NEAR * length.max()]
    found = []
    for target in np.sort(np.arctan2(same[:, 1], same[:, 0])):
        for mirror in (1.0, -1.0):
            c, s = np.cos(target - mirror * angle), np.sin(target - mirror * angle)
            turn = np.array([[c, -s], [s, c]]) @ np.diag([1.0, mirror])
            cells = vectors @ turn.T @ np.linalg.inv(vectors)
            if np.abs(cells - np.rint(cells)).max() < 1e-6:
                found.append(turn)
    return sorted(found, key=lambda turn: bool(np.abs(turn - np.eye(2)).max() > 1e-9))


def _image(moved: Floats, points: cKDTree, near: float) -> Ints | None:
    """(n,) the point onto which each one is moved; None if there is none, or one for two."""
    if points.n == 0:
        return np.empty(0, dtype=np.int64)
    index = points.query(moved, distance_upper_bound=near)[1]  # n where there is none
    if index.max() == points.n or not np.bincount(index, minlength=points.n).all():
        return None
    return np.asarray(index, dtype=np.int64)


def _same_sides(corner: Ints | None) -> bool:
    """Whether neighbouring corners become neighbours: others may have the same places, joined in another order."""
    if corner is None:
        return False
    step = (np.roll(corner, -1) - corner) % len(corner)
    return bool((step == 1).all() or (step == len(corner) - 1).all())


def _same_arms(layout: Layout, inner: cKDTree, turn: Floats, shift: Floats, star: Ints, near: float) -> bool:
    """Whether arms, which points `inner` tell apart, come to lie on arms of the same sizes."""
    arm = _image(inner.data @ turn.T + shift, inner, near)
    if arm is None or not np.array_equal(layout.arm_star[arm], star[layout.arm_star]):
        return False
    same_size = all((np.abs(s[arm] - s) <= NEAR * s).all() for s in (layout.arm_thickness, layout.arm_width))
    tips = layout.arm_tip @ turn.T + shift
    return same_size and bool(np.abs(tips - layout.arm_tip[arm]).max(initial=0.0) < near)


def _same_pins(pins: tuple[Floats, Floats, Ints], turn: Floats, shift: Floats, near: float) -> bool:
    """Whether the pins of `pin_places`, with their places in space, are mapped onto themselves."""
    printed, place, kind = pins
    if len(printed) == 0:
        return True
    # points of another kind are moved far away, so that they are not taken for an image
    apart = 10.0 * (1.0 + float(np.abs(printed).max())) * kind[:, None]
    image = _image(np.hstack([printed @ turn.T + shift, apart]), cKDTree(np.hstack([printed, apart])), near)
    if image is None:
        return False
    moved = place.copy()
    moved[:, :2] = place[:, :2] @ turn.T
    gap = place[image] - moved
    # in space the pins may have another centre than in print: one shift for all of them
    return bool(np.nanmax(np.nanmax(gap, axis=0, initial=-np.inf) - np.nanmin(gap, axis=0, initial=np.inf)) < near)


def _keeps_directions(design: Design, turn: Floats) -> bool:
    """Whether the stretch along x and y, and the weight if there is any, are the same after the motion."""
    stretch = np.diag(design.fabric.stretch_xy)
    if np.abs(turn @ stretch - stretch @ turn).max() > NEAR:
        return False
    pull = np.asarray(design.gravity.direction[:2]) / np.linalg.norm(design.gravity.direction)
    return not design.gravity.on or bool(np.abs(turn @ pull - pull).max() < NEAR)
