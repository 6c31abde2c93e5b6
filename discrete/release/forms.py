"""The forms of a design: minima from many starts on the coarse mesh; the lowest are solved on the fine mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.release.continuation import Report, prefixed_report, solve_on_mesh
from asterism.discrete.release.equilibrium import Equilibrium, roll_axis_deg
from asterism.discrete.release.levels import Ladder, MeshLevel, SharedSearch, solve_through_levels
from asterism.discrete.release.mesh_error import motions_left_free, places
from asterism.discrete.release.release_start import release_starts, start_of_design
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.free_motions import FreeMotions
from asterism.pattern.layout.symmetries import Symmetry, distances_of_images, symmetries

SAME_FORM_PERCENT = 0.5  # % of the diameter, rms distance below which two minima are the same form


@dataclass(frozen=True)
class ExactForm:
    """One of the minima of a design, and the starts that led to it."""

    equilibrium: Equilibrium  # the minimum, on the mesh of `model`
    model: DiscreteModel  # the model
    starts: tuple[str, ...]  # names of the starts that ended in this form, in their order
    default: bool  # the default start is one of them
    levels: tuple[MeshLevel, ...] = ()  # the effort on the finer meshes; empty before they are solved

    def places(self, printed: Array) -> Array:
        """(n, 3) mm, places of printed points (n, 2), linear in each triangle."""
        return places(self.model, self.equilibrium.state.positions, printed)

    @property
    def free_motions(self) -> FreeMotions:
        """The rigid motions that the supports leave free."""
        return motions_left_free(self.model, self.equilibrium.state.positions)

    @property
    def roll_axis_deg(self) -> float | None:
        """Axis of a rolled sheet in printed coordinates, 0 to 180 deg; None for other shapes."""
        return roll_axis_deg(self.model, self.equilibrium.state)

    @property
    def stars_off_branch(self) -> list[int]:
        """Stars that are not on the side of their branch, see `stars_off_branch`."""
        return stars_off_branch(self.model, self.equilibrium)


@dataclass(frozen=True)
class Minima:
    """The forms that many starts have reached."""

    # forms on the fine mesh: first those with all stars on the side of their branch, then by energy. The first form is
    # the result.
    fine: list[ExactForm]
    coarse: list[ExactForm]  # forms on the coarse mesh, in the same order
    refined: list[bool]  # for each coarse form, whether it was solved on the fine mesh
    lost_starts: int  # number of starts that ended in no minimum
    symmetries: list[Symmetry]  # symmetries of the design

    def distance_percent(self, first: ExactForm, second: ExactForm) -> float:
        """Rms distance of the places in % of the diameter, up to free motions and symmetries of the design."""
        return _form_distance(first, second, self.symmetries)[0]


def find_minima(ladder: Ladder, starts: int, backend: str = "auto", report: Report | None = None) -> Minima:
    """Find the forms of a design from a fixed sequence of starts, the start of the design first.

    The result is the lowest minimum whose stars are all on the side of their branch, if there is one: a print starts on
    these sides. Otherwise it is the lowest minimum. Raises `ValueError` if `starts` is below 1.

    Parameters
    ----------
    ladder : the models of the sheet.
    starts : number of starts, see `release_starts`.
    backend, report : as in `solve_on_mesh`.
    """
    if starts < 1:
        raise ValueError(f"starts = {starts}: must be at least 1")
    model = ladder.models[0]
    search = SharedSearch(ladder)
    design_symmetries = symmetries(model.design, model.layout)
    forms: list[ExactForm] = []
    lost = 0
    first = start_of_design(model.design)
    for number, release_start in enumerate(release_starts(len(model.layout.centres), starts, first)):
        start_report = prefixed_report(report, f"start {number + 1} of {starts}")
        try:
            end = solve_on_mesh(model, release_start, backend, start_report)
        except (DesignError, FloatingPointError):
            # an error of the design's start is an error of the design; other starts may fail
            if number == 0:
                raise
            lost += 1
            continue
        if end.is_minimum or number == 0:
            forms.append(ExactForm(end, model, (release_start.name,), number == 0))
        else:
            lost += 1
    coarse = _best_first(distinct_forms(forms, design_symmetries))
    # so many forms are solved on the fine mesh, besides the result and that of the default start
    lowest = sorted(range(len(coarse)), key=lambda i: coarse[i].equilibrium.energy)[:6]
    refined = [i == 0 or i in lowest or form.default for i, form in enumerate(coarse)]
    fine = []
    for number, form in enumerate(form for form, chosen in zip(coarse, refined, strict=True) if chosen):
        form_report = prefixed_report(report, f"minimum {number + 1}")
        end, levels = solve_through_levels(search, form.equilibrium, backend, form_report)
        fine.append(replace(form, equilibrium=end, model=ladder.models[len(levels) - 1], levels=tuple(levels)))
    certified = [form for form in fine if form.equilibrium.is_minimum] or fine
    return Minima(_best_first(distinct_forms(certified, design_symmetries)), coarse, refined, lost, design_symmetries)


def distinct_forms(forms: list[ExactForm], design_symmetries: list[Symmetry]) -> list[ExactForm]:
    """The distinct forms: of those nearer than SAME_FORM_PERCENT with the same stars up, the best with all starts."""
    groups: list[list[ExactForm]] = []
    for form in _best_first(forms):
        for group in groups:
            percent, same_sides = _form_distance(group[0], form, design_symmetries)
            if same_sides and percent < SAME_FORM_PERCENT:
                group.append(form)
                break
        else:
            groups.append([form])
    return [
        replace(group[0], starts=tuple(s for f in group for s in f.starts), default=any(f.default for f in group))
        for group in groups
    ]


def _form_distance(first: ExactForm, second: ExactForm, design_symmetries: list[Symmetry]) -> tuple[float, bool]:
    """Distance in % of the diameter, and whether it is to a symmetric image with the same stars up."""
    diameter = first.model.layout.diameter_mm
    at = first.model.layout.compared_points
    distances = distances_of_images(at, first.places(at), second.places, design_symmetries, first.free_motions)
    percent = 100.0 * distances / diameter
    first_sides, second_sides = first.equilibrium.sides, second.equilibrium.sides
    same_sides = np.array([np.array_equal(first_sides, second_sides[image.star]) for image in design_symmetries])
    if same_sides.any() and percent[same_sides].min() < SAME_FORM_PERCENT:
        return float(percent[same_sides].min()), True
    return float(percent.min()), False


def _best_first(forms: list[ExactForm]) -> list[ExactForm]:
    """First the forms with all stars on the side of their branch, then the others, each by energy."""
    return sorted(forms, key=lambda form: (bool(form.stars_off_branch), form.equilibrium.energy))


def stars_off_branch(model: DiscreteModel, equilibrium: Equilibrium) -> list[int]:
    """Stars on the opposite side to their branch; empty for designs with a flat start, which prescribe no side."""
    prescribed = model.layout.star_branch if model.design.solver.start == "bump" else 0
    return [int(i) for i in np.flatnonzero(equilibrium.sides * prescribed < 0)]
