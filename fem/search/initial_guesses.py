"""Selection of initial guesses: the one of lowest energy of every kind, compared on the supports."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.fem.search.candidate_shapes import candidate_shapes
from asterism.fem.search.directions import distinct_shapes, energy_minima
from asterism.fem.search.guess_builder import GuessBuilder, InitialGuess
from asterism.fem.search.mean_fields import mean_fields
from asterism.fem.search.sides import Side
from asterism.fem.search.simple_shapes import SimpleShape
from asterism.fem.shell.shell import Shell

# energies of the flat sheet above the best guess, beyond which guesses are left out
MAX_EXCESS_OVER_FLAT = 20.0
# 1: energy of a supported guess over that of the best one, beyond which it is left out; with 6 it may still be the best
MAX_ENERGY_RATIO = 8.0


def initial_guesses(
    shell: Shell,
    factor: Factor,
    side: Side = "auto",
    candidates: list[SimpleShape] | None = None,
    symmetries: Sequence[Floats] = (),
) -> tuple[list[InitialGuess], list[InitialGuess]]:
    """The best guess of every kind, and the guesses of the best kind in other directions; all meet the supports.

    Guesses with an energy far above the best one are left out without in-plane relaxation.

    Parameters
    ----------
    factor : of `shell.factor()`; it holds another matrix afterwards.
    side : side of the edges; by default that of the rest curvature.
    candidates : shapes that are compared; by default those of `candidate_shapes`.
    symmetries : see `fem.search.directions.distinct_shapes`.

    Returns
    -------
    Both lists, each sorted by energy.
    """
    fields = mean_fields(shell)
    size = shell.extent
    builder = GuessBuilder(shell, factor, fields.centre, fields.stretch)
    families: dict[tuple[str, float, float], list[SimpleShape]] = {}
    for shape in candidate_shapes(fields, size, side) if candidates is None else candidates:
        families.setdefault((shape.name, shape.curvature, shape.across), []).append(shape)
    ranking = _Ranking(shell, builder)
    if not shell.is_free:
        _rank_supported(ranking, list(families.values()))
        return ranking.kinds, []
    others: dict[SimpleShape, list[SimpleShape]] = {}
    for family in families.values():
        shape, *more = energy_minima(shell, fields.stretch, family) if len(family) > 1 else family
        others[shape] = distinct_shapes(shape, more, symmetries)
    bent = [shape for shape in others if shape.name != "flat"]
    if len(bent) == 1 and bent[0].name == "arc" and not others[bent[0]]:
        # an arc has the lengths of the flat sheet and the target curvature, so it is the best guess
        return [builder.bend(bent[0])], []
    ranking.compare([builder.bend(shape) for shape in others])
    other_directions = [builder.relax_in_plane(builder.bend(shape)) for shape in others[ranking.kinds[0].shape]]
    return ranking.kinds, sorted(other_directions, key=_energy)


class _Ranking:
    """Relaxes guesses in plane while they may be the best, and keeps the best guess of every kind."""

    def __init__(self, shell: Shell, builder: GuessBuilder) -> None:
        self.builder = builder
        self.lowest = np.inf
        self._best: dict[str, InitialGuess] = {}
        # upper bound of the gain by in-plane relaxation
        self._excess = MAX_EXCESS_OVER_FLAT * shell.energies(shell.constrain(shell.flat))["sheet"]
        self._ratio = np.inf if shell.is_free else MAX_ENERGY_RATIO

    def compare(self, guesses: Sequence[InitialGuess]) -> None:
        """Compare further guesses, in the order of their energies."""
        for guess in sorted(guesses, key=_energy):
            if _energy(guess) > min(self.lowest + self._excess, self.energy_limit):
                break
            relaxed = self.builder.relax_in_plane(guess, self.lowest)
            self.lowest = min(self.lowest, _energy(relaxed))
            if relaxed.shape.name not in self._best or _energy(relaxed) < _energy(self._best[relaxed.shape.name]):
                self._best[relaxed.shape.name] = relaxed

    @property
    def energy_limit(self) -> float:
        """Energy in N mm above which a guess is left out."""
        return self.lowest + (self._ratio - 1.0) * abs(self.lowest) if np.isfinite(self.lowest) else np.inf

    @property
    def kinds(self) -> list[InitialGuess]:
        """The best of every kind, the lowest energy first."""
        return sorted(self._best.values(), key=_energy)


def _rank_supported(ranking: _Ranking, families: list[list[SimpleShape]]) -> None:
    """Rank shapes without a direction first, since the directions of an arc are compared only up to their energy."""
    ranking.compare([ranking.builder.bend(family[0]) for family in families if len(family) == 1])
    directed = [family for family in families if len(family) > 1]
    # families that differ only in their curvatures have the same best direction
    best = {len(family): family for family in reversed(directed)}
    number = {count: _best_direction(ranking.builder, family, ranking.energy_limit) for count, family in best.items()}
    ranking.compare([ranking.builder.bend(family[number[len(family)]]) for family in directed])


def _best_direction(builder: GuessBuilder, family: list[SimpleShape], energy_limit: float) -> int:
    """Number of the shape of lowest energy on the supports, of a family with equally spaced angles.

    Every second shape is compared, then the neighbours of the best. If every fourth shape is above `energy_limit` N mm,
    the best of these is returned.
    """
    energies: dict[int, float] = {}
    for numbers in (range(0, len(family), 4), range(2, len(family), 4)):
        energies |= {number: _energy(builder.bend(family[number])) for number in numbers}
        best = min(energies, key=energies.__getitem__)
        if energies[best] > energy_limit:
            return best
    for number in ((best - 1) % len(family), (best + 1) % len(family)):
        energies[number] = _energy(builder.bend(family[number]))
    return min(energies, key=energies.__getitem__)


def _energy(guess: InitialGuess) -> float:
    return guess.energy if np.isfinite(guess.energy) else np.inf
