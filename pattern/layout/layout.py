"""The layout of a design: stars, arms, border and pins in print coordinates (mm on the stretched fabric)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pattern.geometry.arrays import Floats, Ints


@dataclass(frozen=True)
class PinSet:
    """Places of the sheet held in space, all in the same way.

    Attributes
    ----------
    points : (P, 2) mm, isolated printed points (corners of the border included).
    edges : border edges held along their whole length; edge `i` runs from `border[i]` to `border[i + 1]`.
    fixed : which of x, y, z are held; the others are free to slide.
    scale : x and y are held at `scale` times the printed place (about the origin of the print), z at 0.
    offset_mm : added to the place given by `scale`.
    target_mm : (P, 3) places in space, one a point; takes the place of `scale` and `offset_mm`.
    step : 0 holds the sheet during its release; 1, 2, ... take hold of the released sheet, in this order.
    """

    points: Floats
    edges: tuple[int, ...]
    fixed: tuple[bool, bool, bool]
    scale: float = 1.0
    offset_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    target_mm: Floats | None = None
    step: int = 0

    @property
    def is_along_print(self) -> bool:
        """It holds x or y, and does not let its places slide in the plane."""
        return self.fixed[0] or self.fixed[1]

    def places(self, printed: Floats) -> Floats:
        """Where the printed points (n, 2) are held, (n, 3) mm; only the components in `fixed` count."""
        if self.target_mm is not None:
            # one target a point: printed points come from the mesh in the order of `points`
            return np.asarray(self.target_mm, dtype=float)
        flat = np.column_stack([self.scale * printed, np.zeros(len(printed))])
        return flat + np.asarray(self.offset_mm)


@dataclass(frozen=True)
class Layout:
    """What is printed, and where the sheet is held.

    Attributes
    ----------
    border : (B, 2) mm, simple polygon, counterclockwise, not closed.
    centres : (S, 2) mm, star centres; stars without arms (length 0, removed) are not listed.
    arm_star : (A,) the star of each arm; the arms of a star follow each other counterclockwise.
    arm_tip : (A, 2) mm, tip of each arm, after cutting at the border.
    arm_thickness, arm_width : (A, 2) mm, at the star's centre and at the tip, linear between.
    neighbours : (N, 2) pairs of stars a step of the lattice's shortest basis apart, or as near as its longer one.
    pins : how the sheet is held; empty for a free sheet.
    lattice_vectors : (2, 2) mm, rows, as of `Lattice.vectors`; star centres are integer combinations of them plus
        `lattice_origin`.
    lattice_origin : (2,) mm.
    star_branch : (S,) side to which each star starts: 1 up, to the plastic's side (the default), -1 down, 0 neither.
    star_number : (S,) by which the design, and whoever reads results, knows each star; in order.
    """

    border: Floats
    centres: Floats
    arm_star: Ints
    arm_tip: Floats
    arm_thickness: Floats
    arm_width: Floats
    neighbours: Ints
    pins: tuple[PinSet, ...]
    lattice_vectors: Floats
    lattice_origin: Floats
    star_branch: Ints = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    star_number: Ints = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    def __post_init__(self) -> None:
        if len(self.star_branch) == 0:
            object.__setattr__(self, "star_branch", np.ones(len(self.centres), dtype=np.int64))
        if len(self.star_number) == 0:
            object.__setattr__(self, "star_number", np.arange(len(self.centres)))

    @property
    def pin_steps(self) -> tuple[int, ...]:
        """Steps in which the sheet is held: 0, its release, then those of later pins in order."""
        return tuple(sorted({0, *(pin.step for pin in self.pins)}))

    @property
    def pin_points(self) -> Floats:
        """(P, 2) mm, the points of all pins, one set after the other."""
        return np.concatenate([np.empty((0, 2)), *(pin.points for pin in self.pins)])

    @property
    def is_pulled(self) -> bool:
        """Pins hold more than one place along the print.

        Where all of them slide there, or a single point is held, the sheet shapes itself as a free one does.
        """
        along = [pin for pin in self.pins if pin.is_along_print]
        return any(pin.edges for pin in along) or sum(len(pin.points) for pin in along) > 1

    @property
    def spacing_mm(self) -> float:
        """Of the stars: the shorter of the lattice's vectors."""
        return float(np.linalg.norm(self.lattice_vectors, axis=1).min())

    @property
    def arm_length(self) -> Floats:
        """(A,) mm."""
        return np.linalg.norm(self.arm_tip - self.centres[self.arm_star], axis=1)
