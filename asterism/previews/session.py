"""A preview that stays: edits start from where the last one ended."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Literal, NoReturn

import numpy as np

from asterism.previews.all_or_nothing import all_or_nothing
from asterism.previews.fields.star_values import StarValues, star_values
from asterism.previews.search.equilibria import EDIT, settled, taken
from asterism.previews.sheet import Sheet
from asterism.previews.summary import summary
from asterism.previews.surface.surface import Lens, Places, shape_of, shown_mesh
from asterism.previews.uncertainty.contrast import contrast
from asterism.previews.uncertainty.expected_height import height_doubts
from asterism.shape.shape import Shape
from equilibrium.linear.factor import Factor
from equilibrium.newton.minimise import Clock
from equilibrium.threads import one_blas_thread
from fem.elements.tabulation import Floats
from fem.search.evidence import ShellEquilibrium
from fem.search.linear_response import Response, linear_response
from fem.search.mean_fields import mean_fields
from fem.search.relax import energies_by_part, factorise, follow, softest_modes
from fem.search.sides import Side, check_side, side_of
from fem.shell.shell import Shell
from homogenize.law.file import load_law
from homogenize.law.law import Law
from pattern.design.arguments import check_kind
from pattern.design.design import Design
from pattern.design.section import is_whole
from pattern.layout.build import check_carried, layout
from pattern.layout.layout import Layout
from pattern.layout.pin_freedom import tilts
from pattern.layout.symmetries import Symmetry, symmetries
from pattern.mesh.mesh import Mesh

Say = Callable[[str], None]
ALIKE = 0.01  # sizes of stars that differ by less than this part are the same
MANY = 0.4  # part of the stars
LARGE = 300  # triangles: sheets of thousands of stars, of which some need hundreds of iterations
MOST = 10_000  # triangles: many more would fill the memory
FLIPPED: dict[Side, Side] = {"down": "up", "up": "down"}


@cache
def paper_law() -> Law:
    """The law that comes with the package, read once."""
    return load_law()


@dataclass(frozen=True)
class Stage:
    """What an edit has come to.

    Attributes
    ----------
    name : `linear`, the linear response of the last equilibrium to the edit; or `equilibrium`.
    x : (N, 3) mm, positions of the shell's dofs; a copy.
    """

    name: Literal["linear", "equilibrium"]
    x: Floats


class Preview:
    """The homogenised shape of a design, kept ready for changes.

    Parameters
    ----------
    design : from `load_design`, `new` or `Design.from_dict`.
    law : of the design's material; the paper's by default.
    side : to which the edges go: `down`, with the plastic outside, or `up`; `auto` leaves it to the stars.
    triangles : of the shell's mesh, about, at most 10000; by default as many as the stars need.
    say : called with a line of text when something begins.

    Attributes
    ----------
    design, law, side : as given, or as edited since.
    sheet : the print and its mesh.
    values : the law at the design's stars.
    shell, equilibrium : the shell, and its state with the evidence.

    Raises
    ------
    DesignError, MeshError
        The design cannot be printed, or its sheet not meshed.
    LawError
        The law is not for this material, or asks for something impossible at a star.
    TypeError, ValueError
        What is not a design, a law or a side.

    Examples
    --------
    >>> from pattern import gallery
    >>> preview = Preview(gallery.load("dome"))
    >>> preview.equilibrium.is_minimum
    True
    """

    @one_blas_thread()
    def __init__(
        self,
        design: Design,
        law: Law | None = None,
        side: Side = "auto",
        triangles: int | None = None,
        say: Say | None = None,
    ) -> None:
        check_side(side)
        if triangles is not None and not (is_whole(triangles) and 1 <= triangles <= MOST):
            raise ValueError(f"triangles = {triangles!r}: must be a whole number, at least 1 and at most {MOST}")
        if law is not None:
            check_kind(law, Law, "load_law reads one from a file")
        self.shell: Shell
        self._say = say or (lambda text: None)
        self._triangles = triangles
        self._edits = 0
        self._clock = Clock()
        self._factor: Factor
        self._rested: ShellEquilibrium
        self._is_factor_rested: bool
        self.law = law if law is not None else self._clock("law", paper_law)
        self.side: Side = side
        self._begin(design)

    def _begin(self, design: Design) -> None:
        """From nothing."""
        plan = self._clock("layout", layout, design)
        check_carried(design, plan)
        self.values: StarValues = self._clock("law", star_values, design, plan, self.law)
        self.design = design
        self.sheet: Sheet = self._clock("mesh", Sheet, design, plan, self._triangles)
        self._shown: tuple[Mesh, Lens] | None = None
        self._symmetries: list[Symmetry] | None = None
        count = self.sheet.space.mesh.nelements
        patience = ": this may take a minute" if count > LARGE else ""
        stars = len(plan.centres)
        self._say(f"{stars} star{'s' if stars > 1 else ''} on {count} triangles{patience}")
        self._settle()

    def _settle(self) -> None:
        """The equilibrium from simple shapes, and through the steps of the pins."""
        fields = self._clock("fields", self.sheet.fields, self.values)
        curls = len(self.values.tight) > MANY * len(self.values.sizes)
        uniform = bool((np.ptp(self.values.sizes, axis=0) <= ALIKE * self.values.sizes.max(axis=0)).all())
        free = True
        for step in self.sheet.layout.pin_steps:
            shell = self._clock("shell", self.sheet.shell, self.design, fields, step)
            factor = shell.factor()
            if step == 0:
                turns = [symmetry.turn for symmetry in self.symmetries] if shell.is_free else []
                found: ShellEquilibrium = self._clock(
                    "equilibrium", settled, shell, factor, self.side, uniform, curls, turns
                )
            else:
                found = self._clock("pins", taken, shell, factor, found.x, free)
            free = len(shell.fixed_points) == 0
        # all at once: who interrupts the steps keeps the sheet that was there
        vars(self).update(shell=shell, _factor=factor)
        self._rest(found)

    def _rest(self, found: ShellEquilibrium) -> None:
        """Where the sheet is now, its Hessian in the factor: later edits go on from there."""
        found = replace(found, x=self.shell.shifted_to_ground(found.x))
        vars(self).update(equilibrium=found, _rested=found, _is_factor_rested=True)

    def edit(self, design: Design) -> Iterator[Stage]:
        """Change the design: first the linear response, at once, and then the equilibrium.

        Where outline, pins, lattice and gravity are the same the shape goes on from what it was; otherwise, and where
        that leads nowhere, it starts anew, without a linear response. Only starts meet other forms: after an edit that
        goes on, the summary knows of none.

        Nothing happens before the first stage is asked for; `update` asks for all. Who stops after the linear response
        has a preview of that, which says that it is no equilibrium, if the edit changed anything; the next edit's
        linear response is that of the last equilibrium again. Who is interrupted before has the preview that was there.

        Raises
        ------
        DesignError, MeshError, LawError
            As for a new preview; the old one then stays as it was.
        RuntimeError
            A later edit or a flip has overtaken this one.
        TypeError
            It is no design; at once.
        """
        check_kind(design, Design, "load_design reads one from a file")
        return self._stages(design)

    def update(self, design: Design) -> Shape:
        """Change the design and go on to its equilibrium; what `edit` raises, and its shape."""
        for _ in self.edit(design):
            pass
        return self.shape()

    def _stages(self, design: Design) -> Iterator[Stage]:
        with one_blas_thread():
            self._clock = Clock()
            plan = self._clock("layout", layout, design)
            check_carried(design, plan)
            values = self._clock("law", star_values, design, plan, self.law)
            number = self._edits + 1
            if self.sheet.holds(design, plan, self.design):
                with all_or_nothing(self, self.sheet, self.shell):
                    self._clock("fields", self._change, design, plan, values)
                    linear = self._respond()
                    self._edits = number
            else:
                # complete before it takes the place of the old one
                anew = Preview(design, self.law, self.side, self._triangles, self._say)
                vars(self).update({**vars(anew), "_edits": number})
                linear = None
        if linear is not None:
            yield Stage("linear", self.equilibrium.x.copy())
            if self._edits != number:
                raise RuntimeError("this edit was overtaken by a later one, or by a flip")
            with one_blas_thread():
                self._is_factor_rested = False
                found = self._clock("equilibrium", follow, self.shell, linear.x, self._factor, EDIT, linear.strains)
                if found.is_minimum:
                    self._rest(found)
                else:
                    self._settle()
        yield Stage("equilibrium", self.equilibrium.x.copy())

    def _change(self, design: Design, plan: Layout, values: StarValues) -> None:
        """New stars on the same sheet."""
        if not (self.sheet.has_arms(plan) and design.mesh == self.design.mesh):
            self._shown = None
        self.sheet.set_stars(design, plan)
        fields = self.sheet.fields(values)
        self.design, self.values = design, values
        self._symmetries = None
        self.shell.set_fields(fields)
        if design.gravity.on:
            self.shell.loads = self.sheet.loads(design)

    def _respond(self) -> Response | None:
        """The sheet after a change, to first order: until it went on, the preview is of no equilibrium.

        None where the last equilibrium's Hessian was lost and it is no longer stable; the sheet then starts anew.
        """
        old = self._rested
        if not self._is_factor_rested:
            self._is_factor_rested = factorise(self.shell, old.x, self._factor)
        if not self._is_factor_rested:
            self._settle()
            return None
        linear = self._clock("linear response", linear_response, self.shell, old.x, self._factor)
        gradient = float(np.linalg.norm(self.shell.gradient(linear.x)))
        self.equilibrium = replace(
            old,
            x=self.shell.shifted_to_ground(linear.x),
            strains=linear.strains,
            energies=energies_by_part(self.shell, linear.x),
            gradient_norm=gradient,
            definite=old.definite and gradient <= old.tolerance,
            soft_modes=np.empty(0),
            trials=(),
        )
        return linear

    @one_blas_thread()
    def flip(self) -> Side:
        """Turn the edges to the other side of the print; returns the side they have now.

        That is the side they had where no form on the other one was found; the preview is then what it was.
        """
        self._clock = Clock()
        self._edits += 1
        now = side_of(self.shell, self.equilibrium.x)
        now = mean_fields(self.shell).side if now == "auto" else now
        before = dict(vars(self))
        with all_or_nothing(self):
            self.side = FLIPPED[now]
            self._settle()
        if side_of(self.shell, self.equilibrium.x) == self.side:
            return self.side
        vars(self).update(before)
        return now

    def __reduce__(self) -> NoReturn:
        """Refuse copies, which would share the shell that edits change."""
        raise TypeError("a preview cannot be copied or pickled: Preview(preview.design, preview.law) makes another")

    @property
    def symmetries(self) -> list[Symmetry]:
        """Motions of the print that change nothing."""
        if self._symmetries is None:
            self._symmetries = self._clock("symmetries", symmetries, self.design, self.sheet.layout)
        return self._symmetries

    @property
    def seconds(self) -> dict[str, float]:
        """Of wall time by part, since the preview was made, edited or flipped."""
        return dict(self._clock.seconds)

    def at(self, points: Floats, x: Floats | None = None) -> Places:
        """Printed points (n, 2) mm, or a single one, in space; `x` of a stage in place of the equilibrium.

        In the shell's own pose: free sheets of `shape` are turned upright.

        Raises
        ------
        ValueError
            These are no points, or one is off the sheet; x is no stage's.
        """
        points = np.atleast_2d(np.asarray(points, dtype=float))
        if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
            raise ValueError(f"points must be finite pairs of mm on the print, shape (n, 2), got shape {points.shape}")
        if x is not None:
            x = np.asarray(x, dtype=float)
            if x.shape != self.equilibrium.x.shape:
                raise ValueError(f"x must be a stage's, shape {self.equilibrium.x.shape}, got shape {x.shape}")
        return Lens(self.sheet, self.law.waves, points)(self.equilibrium.x if x is None else x, self.values)

    @one_blas_thread()
    def shape(self) -> Shape:
        """The sheet with its stars' bumps, as files and pictures show it."""
        self._find_soft_modes()
        if self._shown is None:
            mesh = self._clock("shown", shown_mesh, self.design, self.sheet)
            self._shown = mesh, self._clock("shown", Lens, self.sheet, self.law.waves, mesh.points)
        mesh, lens = self._shown
        places = self._clock("shown", lens, self.equilibrium.x, self.values)
        shape = self._clock("shown", shape_of, self.design, self.sheet, mesh, places)
        up = np.eye(3)[2]
        if not shape.held:
            shape, up = shape.aligned(), shape.upright()[2]
        doubts, depends = None, 0.0
        # pins that let the sheet tilt leave open what counts as its height, unless weight tells
        certain = self.design.gravity.on or not shape.held or not tilts(self.sheet.layout)
        if self.equilibrium.is_minimum and certain:
            doubts = self._clock("expected height", height_doubts, self, shape, up, self._factor)
        if self.equilibrium.is_minimum and not self.sheet.layout.is_pulled:
            depends = self._clock("contrast", contrast, self, self._factor)
        return replace(shape, summary=summary(self, shape, mesh, doubts, depends, self.seconds))

    def _find_soft_modes(self) -> None:
        """What the error to be expected follows from; an edit does not wait for it. The factor is the equilibrium's."""
        found = self.equilibrium
        if found.is_minimum and not self._is_factor_rested:  # an edit that changes nothing was broken off
            self._is_factor_rested = factorise(self.shell, found.x, self._factor)
        if found.is_minimum and not len(found.soft_modes):
            values, _ = self._clock("soft modes", softest_modes, self.shell, found.x, self._factor)
            self.equilibrium = replace(found, soft_modes=values)
