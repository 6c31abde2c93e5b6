"""The range of shapes that prints of one design may have, by a few exact shapes about that of the design.

A value is t half intervals away from that of the design, factors by their logarithm; t is normal, with 95 % from -1
to 1. One value at a time goes to an end of its interval, on the mesh of the design's shape, so that errors of the mesh
cancel. Height and positions follow each t linearly, or as a parabola where both ends are known.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pydantic import ValidationError

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.release.continuation import Report, prefixed_report, solve_on_mesh
from asterism.discrete.release.equilibrium import Equilibrium
from asterism.discrete.release.forms import ExactForm, distinct_forms
from asterism.discrete.release.levels import model_on
from asterism.discrete.release.mesh_error import motions_left_free
from asterism.discrete.release.prolongation import fit_to_surface
from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.threads import one_blas_thread
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError, check_type, from_validation
from asterism.pattern.design.materials import BendingStiffness, Fabric, Plastic, ResidualCurvature
from asterism.pattern.design.spread import Spread
from asterism.pattern.design.stars import ROD_SIZES, THICKNESS, THICKNESS_RANGE_MM
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.geometry.point_location import locate
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.process.progress import Say, ignore_line
from asterism.results.records.exact import (
    VALUES,
    ExactRecord,
    MeasurementRecord,
    SpreadEndRecord,
    SpreadRecord,
    SpreadShareRecord,
)
from asterism.shape.shape import Shape

# what makers can measure, and the intervals that it leaves
MEASUREMENTS = {
    "strips of plastic": Spread(modulus_ratio_factor=1.1, kappa_bar_error_per_mm=0.0005),
    "stretch after the release": Spread(stretch_percent=2.0),
    "overhang of the fabric": Spread(bending_factor=1.2),
    "thickness with a caliper": Spread(thickness_error_mm=0.01),
    "direction of the grain": Spread(grain_error_deg=1.0),
}
# The first end of an interval is where the sheet curls or buckles more, and its height is the least linear: the lower
# end of these values, the upper one of the others.
LOWER_END_FIRST = {"modulus_ratio_factor", "bending_factor", "thickness_error_mm"}
END_NAMES = {1: "upper end", -1: "lower end"}
HALF_INTERVAL_SIGMAS = 1.96  # 95 % of a normal distribution
NINE_IN_TEN = (0.05, 0.5, 0.95)
SAMPLES = 4000
# 1: rms distance of exact heights from the response over their standard deviation, 0.17 to 0.38 for 40 random materials
# of three sheets; it counts as independent of the values
RESPONSE_ERROR = 0.35
# with the shape of the design; one of them goes back from the furthest end
MAX_SOLVES = 10


class _ScaledFabric(Fabric):
    """Fabric whose bending stiffness alone is another, which designs cannot say of every bending energy."""

    bending_scale: float = 1.0

    @property
    def bending_tensor(self) -> BendingStiffness:
        return BendingStiffness(*(self.bending_scale * each for each in super().bending_tensor))


@one_blas_thread()
def spread(shape: Shape, backend: str = "auto", report: Report | None = None, say: Say | None = None) -> Shape:
    """Compute the range of shapes that prints of one design may have.

    The intervals are those of the design's section `[spread]`, or its defaults. At most nine further exact shapes are
    computed.

    Parameters
    ----------
    shape : exact shape of the design, from `simulate` or `read_shape`.
    backend, report, say : as in `simulate`.

    Returns
    -------
    The same shape with the range: `shape.summary.spread`. Its warnings name what makes the range unreliable, such as
    another form of the sheet within the intervals.

    Raises
    ------
    DesignError
        The shape is not an exact minimum, or an end of an interval cannot be printed.

    Examples
    --------
    >>> import asterism
    >>> star = asterism.spread(asterism.simulate(asterism.new("star"), starts=1))
    >>> star.summary.spread.height_low_mm < star.height_mm < star.summary.spread.height_high_mm
    True
    """
    check_type(shape, Shape, "simulate makes one")
    if not isinstance(shape.summary, ExactRecord) or not shape.summary.get("is_minimum"):
        raise DesignError("", "must be a stable exact shape, as asterism.simulate computes it, for its spread")
    begin = time.perf_counter()
    design = Design.from_dict(shape.summary["design"])
    plan = layout(design)
    names = check_spread(design, plan)
    model = model_on(design, plan, shape.summary.edge_mm)
    search = _Search(shape, model, backend, report, say or ignore_line)
    for name in names:
        search.solve_end(name, -1 if name in LOWER_END_FIRST else 1)
    # the other ends of the values that move the sheet most, and one way back: the height may be at its largest
    for end in search.furthest()[: MAX_SOLVES - 1 - search.solves]:
        search.solve_end(end.record.value, -end.record.end)
    search.check_furthest()
    record = _record(design.spread or Spread(), names, search, time.perf_counter() - begin)
    warnings = [*shape.summary["warnings"], *_warnings(record)]
    return replace(shape, summary=shape.summary | {"spread": record, "warnings": warnings})


def check_spread(design: Design, plan: Layout) -> list[str]:
    """The keys of `[spread]` whose values the design has, and are not known.

    Raises DesignError: an interval has an end that cannot be printed, or all values are known.
    """
    spread = design.spread or Spread()
    known, off = _values_at(spread, {}), _values_at(spread, dict.fromkeys(VALUES, 1.0))
    without = {"grain_error_deg": not design.fabric.is_orthotropic, "bending_factor": not design.fabric.has_bending}
    names = [name for name in VALUES if off[name] != known[name] and not without.get(name, False)]
    if not names:
        raise DesignError("spread", "must have an interval of a value that the design has")
    for name in names:
        for end in (1.0, -1.0):
            try:
                varied(design, plan, {name: end})
            except DesignError as error:
                raise DesignError(f"spread.{name}", f"is too wide: {error}", getattr(spread, name)) from None
    return names


def varied(design: Design, plan: Layout, t: Mapping[str, float]) -> tuple[Design, Layout]:
    """The design and the layout of a print whose values are t half intervals of the spread away, by their keys.

    Raises DesignError: a value is not allowed, or a rod is too thin or too thick.
    """
    fabric, plastic, off = design.fabric, design.plastic, _values_at(design.spread or Spread(), t)
    strain = 1.0 + 0.01 * off["stretch_percent"]
    stretch = tuple(1.0 + (each - 1.0) * strain for each in fabric.stretch_xy)
    given: dict[str, Any] = fabric.model_dump(exclude_none=True) | {"bending_scale": off["bending_factor"]}
    given["stretch"] = stretch[0] if stretch[0] == stretch[1] else stretch
    if off["grain_error_deg"]:
        given["grain_deg"] = ((fabric.grain_deg or 0.0) + off["grain_error_deg"]) % 180.0
    kept, more, thicker = plastic.kappa_bar_per_mm, off["kappa_bar_error_per_mm"], off["thickness_error_mm"]
    bar: Any = (
        kept.model_dump() | {"per_mm": tuple(each + more for each in kept.per_mm)}
        if isinstance(kept, ResidualCurvature)
        else kept + more
    )
    ratio = plastic.modulus_ratio * off["modulus_ratio_factor"]
    try:
        new = {
            "fabric": _ScaledFabric(**given),
            "plastic": Plastic(**(plastic.model_dump() | {"modulus_ratio": ratio, "kappa_bar_per_mm": bar})),
        }
    except ValidationError as error:
        raise from_validation(error) from None
    low, high = THICKNESS_RANGE_MM
    thickness = np.concatenate([rod.thickness for rod in plan.graph.rods]) + thicker
    more_section = np.where([size is THICKNESS for size in ROD_SIZES], thicker, 0.0)
    if thickness.min() < low or thickness.max() > high:
        worst = thickness.min() if thickness.min() < low else thickness.max()
        raise DesignError("", f"a thickness of {worst:.3g} mm must be from {low:g} to {high:g}")
    drawn = plan.drawn
    if drawn is not None:
        bars = [None if rod.kappa_bar is None else rod.kappa_bar + more for rod in drawn.rods]
        rods = zip(drawn.rods, bars, strict=True)
        drawn = replace(
            drawn, rods=tuple(replace(rod, sections=rod.sections + more_section, kappa_bar=bar) for rod, bar in rods)
        )
    return design.model_copy(update=new), replace(plan, arm_sections=plan.arm_sections + more_section, drawn=drawn)


def varied_model(model: DiscreteModel, t: Mapping[str, float]) -> DiscreteModel:
    """The model of a print that is t half intervals of the spread away from its design, on the same mesh."""
    return type(model)(*varied(model.design, model.layout, t), model.mesh)


def _values_at(spread: Spread, t: Mapping[str, float]) -> dict[str, float]:
    """Factors and additions by the keys of `[spread]`, t half intervals away from the design."""
    values = {}
    for name in VALUES:
        half, away = getattr(spread, name), t.get(name, 0.0)
        values[name] = half**away if name.endswith("_factor") else half * away
    return values


@dataclass(frozen=True)
class _End:
    """A computed end: its record, its equilibrium, and its values less those of the design."""

    record: SpreadEndRecord
    equilibrium: Equilibrium
    change: Floats


@dataclass(frozen=True)
class _Line:
    """A straight line on the print: corners (n, 3) and weights (n, 3) of its points; (2,) its way on the ground."""

    corners: Ints
    weights: Floats
    along: Floats

    @classmethod
    def through_highest_point(cls, model: DiscreteModel, positions: Floats) -> _Line:
        """The line of largest height from one edge of the sheet to the other."""
        plan, mesh = model.layout, model.mesh
        top, reach = mesh.points[positions[:, 2].argmax()], 2.0 * plan.diameter_mm
        lines, count = [], 201  # points of the line
        for angle in np.pi / 12 * np.arange(12):
            direction = np.array([np.cos(angle), np.sin(angle)])
            away = np.linspace(-reach, reach, 8 * count + 1)
            off = np.flatnonzero(~plan.is_on_sheet(top + away[:, None] * direction))
            # a point on the edge is on the sheet or beside it
            middle = away[np.abs(away).argsort()[:3]]
            before, after = away[off][away[off] < middle.min()], away[off][away[off] > middle.max()]
            points = top + np.linspace(before.max(), after.min(), count)[:, None] * direction
            triangle, weights = locate(mesh.points, mesh.triangles, points, plan.spacing_mm)
            corners = mesh.triangles[triangle]
            at = np.einsum("nk,nki->ni", weights, positions[corners])
            ground = at[:, :2] - at[:, :2].mean(axis=0)
            lines.append((np.ptp(at[:, 2]), cls(corners, weights, np.linalg.svd(ground, full_matrices=False)[2][0])))
        return max(lines, key=lambda line: float(line[0]))[1]

    def seen(self, positions: Floats) -> Floats:
        """(n, 2) mm, along the ground and up, on positions (V, 3)."""
        at = np.einsum("nk,nki->ni", self.weights, positions[self.corners])
        return np.column_stack([at[:, :2] @ self.along, at[:, 2]])


class _Search:
    """The exact shapes about that of the design. Values are height, length, width, and the line on the print."""

    def __init__(self, shape: Shape, model: DiscreteModel, backend: str, report: Report | None, say: Say) -> None:
        self.shape, self.model, self.backend, self.report, self.say = shape, model, backend, report, say
        surface = shape.at_edges(model.mesh.points)
        self.ends: dict[tuple[str, int], _End] = {}
        self.solves = 0
        self.base = self._solve(model, fit_to_surface(model, surface), "the shape of the design")
        if not self.base.is_minimum:
            raise DesignError("", "the shape does not become a minimum of its design again: compute it anew")
        self.line = _Line.through_highest_point(model, self.base.state.positions)
        self.values = self._values(self.base)

    def solve_end(self, name: str, end: int) -> None:
        """The shape with one value at an end of its interval."""
        model = varied_model(self.model, {name: float(end)})
        found = self._solve(model, self.base.state, f"{VALUES[name]} at its {END_NAMES[end]}")
        values, base = self._values(found), self.base.state.positions
        gaps = self._laid(found) - base
        record = SpreadEndRecord(
            value=name,
            end=end,
            height_mm=float(values[0]),
            distance_percent=float(100.0 * np.sqrt((gaps**2).sum(axis=1).mean()) / diameter(base)),
            is_minimum=found.is_minimum,
            stars_turned=int((found.sides != self.base.sides).sum()),
            comes_back=None,
        )
        self.ends[name, end] = _End(record, found, values - self.values)

    def furthest(self) -> list[_End]:
        """The ends, beginning with that furthest from the shape of the design."""
        return sorted(self.ends.values(), key=lambda end: -end.record.distance_percent)

    def check_furthest(self) -> None:
        """Take back the values of the furthest ends, as many as there are solves left: is it the same form?"""
        design_symmetries = symmetries(self.model.design, self.model.layout)
        start = ExactForm(self.base, self.model, ("design",), True)
        for end in self.furthest()[: MAX_SOLVES - self.solves]:
            record = end.record
            back = self._solve(self.model, end.equilibrium.state, f"back from {VALUES[record.value]}")
            forms = distinct_forms([start, ExactForm(back, self.model, ("back",), False)], design_symmetries)
            self.ends[record.value, record.end] = replace(end, record=record | {"comes_back": len(forms) == 1})

    def response(self, names: list[str]) -> tuple[Floats, Floats]:
        """Slope and curve (names, values) of the change `t @ slope + t^2 @ curve`; without an end it is linear."""
        known = {at: end.change for at, end in self.ends.items()}
        up, down = (
            np.array([known[name, end] if (name, end) in known else -known[name, -end] for name in names])
            for end in (1, -1)
        )
        return 0.5 * (up - down), 0.5 * (up + down)

    def _solve(self, model: DiscreteModel, state: Any, name: str) -> Equilibrium:
        self.solves += 1
        self.say(f"spread: {name}")
        return solve_on_mesh(model, state, self.backend, prefixed_report(self.report, f"spread, {name}"))

    def _laid(self, found: Equilibrium) -> Floats:
        """(V, 3) mm, positions laid on those of the design by the motions that the supports leave free."""
        positions = found.state.positions
        rotation, shift = motions_left_free(self.model, positions).fit(positions, self.base.state.positions)
        return np.asarray(positions @ rotation.T + shift)

    def _values(self, found: Equilibrium) -> Floats:
        """(3 + 2 n,) mm, height, length and width, and along the ground and up of the points of the line."""
        mesh = self.model.mesh
        shape = replace(self.shape, printed=mesh.points, positions=found.state.positions, triangles=mesh.triangles)
        shape = shape if shape.held else shape.aligned()
        sizes = np.array([shape.height_mm, *shape.extent_mm[:2]])
        return np.concatenate([sizes, self.line.seen(self._laid(found)).ravel()])


def _record(spread: Spread, names: list[str], search: _Search, wall: float) -> SpreadRecord:
    slope, curve = search.response(names)
    normal = np.random.default_rng(0).standard_normal((SAMPLES, len(names) + 1))
    t, error = normal[:, :-1] / HALF_INTERVAL_SIGMAS, RESPONSE_ERROR * normal[:, -1:]

    def nine_in_ten(values: Floats) -> Floats:
        """(3, 3) mm, `NINE_IN_TEN` of height, length and width, with the random error of the response."""
        sizes = values[:, :3]
        return np.asarray(np.quantile(np.maximum(sizes + error * sizes.std(axis=0), 0.0), NINE_IN_TEN, axis=0))

    prints = search.values + t @ slope + t**2 @ curve
    low, median, high = nine_in_ten(prints)
    parts = (t * slope[:, 0] + t**2 * curve[:, 0]).var(axis=0)
    shares = [
        SpreadShareRecord(
            value=name,
            variance_percent=float(100.0 * part / max(parts.sum(), 1e-300)),
            heights_mm=(search.values[0] + curve[i, 0] + np.array([-1.0, 1.0]) * slope[i, 0]).tolist(),
        )
        for i, (name, part) in enumerate(zip(names, parts, strict=True))
    ]
    measurements = []
    for name, measured in MEASUREMENTS.items():
        left = np.array([_left(spread, measured, each) for each in names])
        if left.min() < 1.0:
            after = nine_in_ten(search.values + (left * t) @ slope + (left * t) ** 2 @ curve)[:, 0]
            measurements.append(MeasurementRecord(name=name, low_mm=float(after[0]), high_mm=float(after[2])))
    # prints whose mean is shown
    near = [np.abs(prints[:, 0] - each[0]).argsort()[:200] for each in (low, median, high)]
    lines = [prints[some, 3:].mean(axis=0).reshape(-1, 2).tolist() for some in near]
    return SpreadRecord(
        intervals=spread.model_dump(),
        height_low_mm=float(low[0]),
        height_median_mm=float(median[0]),
        height_high_mm=float(high[0]),
        size_low_mm=low[1:].tolist(),
        size_high_mm=high[1:].tolist(),
        shares=sorted(shares, key=lambda share: -share.variance_percent),
        measurements=sorted(measurements, key=lambda each: each.high_mm - each.low_mm),
        ends=[end.record for end in search.ends.values()],
        line_low_mm=lines[0],
        line_median_mm=lines[1],
        line_high_mm=lines[2],
        solves=search.solves,
        wall_s=wall,
    )


def _left(spread: Spread, measured: Spread, name: str) -> float:
    """What a measurement leaves of an interval, 1 for all of it."""
    if name not in measured.model_fields_set:
        return 1.0
    before, after = getattr(spread, name), getattr(measured, name)
    left = np.log(after) / np.log(before) if name.endswith("_factor") else after / before
    return float(min(left, 1.0))


def _warnings(record: SpreadRecord) -> list[str]:
    """What makes the range unreliable: each line names the end of an interval."""
    lines = []
    for end in record.ends:
        where = f"with {VALUES[end.value]} at its {END_NAMES[end.end]}"
        if not end.is_minimum:
            lines.append(f"{where} no minimum was found: the range of shapes is not reliable")
        elif end.comes_back is False:
            lines.append(f"{where} the sheet goes to another form, and does not come back: prints may have both")
        elif end.stars_turned:
            turned = f"{end.stars_turned} star{'s' if end.stars_turned > 1 else ''}"
            lines.append(f"{where} {turned} bump to another side: prints may have another form")
    return lines
