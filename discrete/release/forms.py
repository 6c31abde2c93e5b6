"""Minima of a design from many starts: found on the coarse mesh, told apart, the best carried to the fine mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from discrete.energies.elements import Array
from discrete.evidence.equilibrium import Equilibrium
from discrete.evidence.roll_axis import roll_axis_deg
from discrete.model.discrete_model import DiscreteModel
from discrete.release.continuation import Report, prefixed_report
from discrete.release.levels import MeshLevel, coarser_models, solve_through_levels
from discrete.release.release_start import release_starts
from discrete.release.single_mesh import solve_on_mesh
from equilibrium.newton.regularisation import Method
from pattern.design.errors import DesignError
from pattern.layout.symmetric_distance import symmetric_distances
from pattern.layout.symmetries import Symmetry, symmetries

SAME_FORM_PERCENT = 0.5  # of the diameter: minima nearer than this are one
MAX_REFINED_FORMS = 6  # lowest minima that are solved on the fine mesh, besides the default start's and the result


@dataclass(frozen=True)
class ExactForm:
    """A minimum and how it was found.

    Attributes
    ----------
    equilibrium : on the mesh of `model`.
    starts : names of the starts that ended here, the first of them first.
    default : the default start did.
    levels : what the finer meshes cost; empty before they were solved.
    """

    equilibrium: Equilibrium
    model: DiscreteModel
    starts: tuple[str, ...]
    default: bool
    levels: tuple[MeshLevel, ...] = ()

    @property
    def centres(self) -> Array:
        """(S, 3) mm."""
        return self.equilibrium.state.positions[self.model.mesh.star_vertices]

    @property
    def roll_axis_deg(self) -> float | None:
        """Axis of the rolled sheet in print coordinates."""
        return roll_axis_deg(self.model, self.equilibrium.state)

    @property
    def stars_off_branch(self) -> list[int]:
        """Stars that are not on the side to which their branch sends them; a flat start sends none."""
        return stars_off_branch(self.model, self.equilibrium)


@dataclass(frozen=True)
class Minima:
    """All that many starts have found.

    Attributes
    ----------
    fine : distinct minima on the fine mesh, those with all stars on their branch first, and by energy; the first is the
        result.
    coarse : distinct minima on the coarse mesh, in the same order.
    refined : for each of them, whether it was solved on the fine mesh as well.
    lost_starts : starts that ended in no minimum.
    symmetries : of the design, for `distance_percent`.
    """

    fine: list[ExactForm]
    coarse: list[ExactForm]
    refined: list[bool]
    lost_starts: int
    symmetries: list[Symmetry]

    def distance_percent(self, first: ExactForm, second: ExactForm) -> float:
        """Rms distance of the star centres over the diameter, modulo rigid motions and symmetries."""
        return _percent(first, second, self.symmetries)[0]


def find_minima(
    model: DiscreteModel,
    starts: int,
    seed: int = 0,
    backend: str = "auto",
    method: Method = "blended",
    max_iterations: int = 500,
    report: Report | None = None,
) -> Minima:
    """Distinct minima from a fixed sequence of starts, the design's own first; other arguments as in `solve_on_mesh`.

    The result is the lowest minimum whose stars are all on the side to which their branch sends them (up, unless the
    layout says otherwise), where there is one: a print does not start from any other.

    Raises
    ------
    ValueError
        Fewer than one start.
    """
    if starts < 1:
        raise ValueError(f"starts = {starts}: must be at least 1")
    models, start = [*coarser_models(model), model], model.design.solver.start
    same = symmetries(model.design, model.layout)
    found: list[ExactForm] = []
    lost = 0
    for number, one in enumerate(release_starts(len(model.layout.centres), starts, start == "bump", seed)):
        tell = prefixed_report(report, f"start {number + 1} of {starts}")
        try:
            end = solve_on_mesh(models[0], one, None, seed, backend, method, max_iterations, tell)
        except (DesignError, FloatingPointError):
            # what the design's own start cannot do is a mistake in it; another one may begin where nothing goes on
            if number == 0:
                raise
            lost += 1
            continue
        if end.is_minimum or number == 0:
            found.append(ExactForm(end, models[0], (one.name,), number == 0))
        else:
            lost += 1
    coarse = distinct_forms(found, same)
    ranked = _best_first(coarse)
    low = sorted(range(len(ranked)), key=lambda i: ranked[i].equilibrium.energy)[:MAX_REFINED_FORMS]
    carried = [i == 0 or i in low or branch.default for i, branch in enumerate(ranked)]
    fine = []
    for number, branch in enumerate(b for b, kept in zip(ranked, carried, strict=True) if kept):
        tell = prefixed_report(report, f"minimum {number + 1}")
        end, levels = solve_through_levels(
            models, branch.equilibrium, start, seed, backend, method, max_iterations, tell
        )
        fine.append(replace(branch, equilibrium=end, model=model, levels=tuple(levels)))
    certain = [b for b in fine if b.equilibrium.is_minimum] or fine
    return Minima(_best_first(distinct_forms(certain, same)), ranked, carried, lost, same)


def distinct_forms(branches: list[ExactForm], same: list[Symmetry]) -> list[ExactForm]:
    """One of each minimum: of those that are nearer than SAME_PERCENT with the same stars up, the best."""
    groups: list[list[ExactForm]] = []
    for branch in _best_first(branches):
        for group in groups:
            percent, alike = _percent(group[0], branch, same)
            if alike and percent < SAME_FORM_PERCENT:
                group.append(branch)
                break
        else:
            groups.append([branch])
    return [
        replace(group[0], starts=tuple(s for b in group for s in b.starts), default=any(b.default for b in group))
        for group in groups
    ]


def _percent(first: ExactForm, second: ExactForm, same: list[Symmetry]) -> tuple[float, bool]:
    """Distance in percent of the diameter, and whether it is to an image with the same stars up."""
    apart = 100.0 * symmetric_distances(first.centres, second.centres, same) / first.model.layout.diameter_mm
    sides, other = first.equilibrium.sides, second.equilibrium.sides
    alike = np.array([np.array_equal(sides, other[symmetry.star]) for symmetry in same])
    if alike.any() and apart[alike].min() < SAME_FORM_PERCENT:
        return float(apart[alike].min()), True
    return float(apart.min()), False


def _best_first(branches: list[ExactForm]) -> list[ExactForm]:
    """By energy, those whose stars are on their branch before the others."""
    return sorted(branches, key=lambda b: (bool(b.stars_off_branch), b.equilibrium.energy))


def stars_off_branch(model: DiscreteModel, found: Equilibrium) -> list[int]:
    """Stars that did not keep the side to which their branch sent them; from a flat start none is sent."""
    sent = model.layout.star_branch if model.design.solver.start == "bump" else 0
    return [int(i) for i in np.flatnonzero(found.sides * sent < 0)]
