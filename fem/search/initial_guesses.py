"""Which guesses to start from: the cheapest of every kind, compared as the conditions hold them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from equilibrium.linear.factor import Factor
from fem.elements.tabulation import Floats
from fem.search.candidate_shapes import candidate_shapes
from fem.search.directions import distinct_shapes, energy_minima
from fem.search.guess_builder import GuessBuilder, InitialGuess
from fem.search.mean_fields import mean_fields
from fem.search.sides import Side
from fem.search.simple_shapes import SimpleShape
from fem.shell.shell import Shell

HOPELESS = 20.0  # over what a flat sheet stores: a guess that is dearer than the best by so much is left out
HELD_DEAR = 8.0  # over the best one's energy: held guesses that are dearer are left out; six times is made up for


def initial_guesses(
    shell: Shell,
    factor: Factor,
    side: Side = "auto",
    candidates: list[SimpleShape] | None = None,
    symmetries: Sequence[Floats] = (),
) -> tuple[list[InitialGuess], list[InitialGuess]]:
    """The best guess of every kind, and the best one in other directions; all meet the conditions.

    Both with the lowest energy first. `symmetries`: see `fem.search.directions.distinct_shapes`. Guesses
    that cost far more than the best one are not moved within themselves any further, or left out.
    """
    wants = mean_fields(shell)
    size = shell.extent
    frame = GuessBuilder(shell, factor, wants.centre, wants.stretch)
    families: dict[tuple[str, float, float], list[SimpleShape]] = {}
    for shape in candidate_shapes(wants, size, side) if candidates is None else candidates:
        families.setdefault((shape.name, shape.curvature, shape.across), []).append(shape)
    ranking = _Ranking(shell, frame)
    if not shell.is_free:
        _rank_held(ranking, list(families.values()))
        return ranking.kinds, []
    others: dict[SimpleShape, list[SimpleShape]] = {}
    for family in families.values():
        shape, *more = energy_minima(shell, wants.stretch, family) if len(family) > 1 else family
        others[shape] = distinct_shapes(shape, more, symmetries)
    bent = [shape for shape in others if shape.name != "flat"]
    if len(bent) == 1 and bent[0].name == "arc" and not others[bent[0]]:
        # it keeps lengths as the flat sheet does, and bends as the fields want: nothing to compare
        return [frame.bend(bent[0])], []
    ranking.take([frame.bend(shape) for shape in others])
    turned = [frame.relax_in_plane(frame.bend(shape)) for shape in others[ranking.kinds[0].shape]]
    return ranking.kinds, sorted(turned, key=_energy)


class _Ranking:
    """Moves guesses within themselves while they may be the best, and keeps the best one of every kind."""

    def __init__(self, shell: Shell, frame: GuessBuilder) -> None:
        self.frame = frame
        self.least = np.inf
        self._best: dict[str, InitialGuess] = {}
        self._more = HOPELESS * shell.energies(shell.constrain(shell.flat))["sheet"]  # no shape can save more than that
        self._times = np.inf if shell.is_free else HELD_DEAR

    def take(self, offered: Sequence[InitialGuess]) -> None:
        """Compare further guesses, the cheapest first."""
        for start in sorted(offered, key=_energy):
            if _energy(start) > min(self.least + self._more, self.dear):
                break
            slid = self.frame.relax_in_plane(start, self.least)
            self.least = min(self.least, _energy(slid))
            if slid.shape.name not in self._best or _energy(slid) < _energy(self._best[slid.shape.name]):
                self._best[slid.shape.name] = slid

    @property
    def dear(self) -> float:
        """N mm from which on a guess is left out."""
        return self.least + (self._times - 1.0) * abs(self.least) if np.isfinite(self.least) else np.inf

    @property
    def kinds(self) -> list[InitialGuess]:
        """The best of every kind, the lowest energy first."""
        return sorted(self._best.values(), key=_energy)


def _rank_held(ranking: _Ranking, families: list[list[SimpleShape]]) -> None:
    """First what has no direction: directions need not be compared where even the best is far too dear."""
    ranking.take([ranking.frame.bend(family[0]) for family in families if len(family) == 1])
    turning = [family for family in families if len(family) > 1]
    # families that differ in their curvatures alone have the same best direction
    best = {len(family): family for family in reversed(turning)}
    number = {count: _best_held(ranking.frame, family, ranking.dear) for count, family in best.items()}
    ranking.take([ranking.frame.bend(family[number[len(family)]]) for family in turning])


def _best_held(frame: GuessBuilder, family: list[SimpleShape], dear: float) -> int:
    """Of held shapes whose angles go round evenly: every other one is tried, then the neighbours of the best.

    If the first few of them are all dearer than `dear` N mm, these will do.
    """
    energies: dict[int, float] = {}
    for numbers in (range(0, len(family), 4), range(2, len(family), 4)):
        energies |= {number: _energy(frame.bend(family[number])) for number in numbers}
        best = min(energies, key=energies.__getitem__)
        if energies[best] > dear:
            return best
    for number in ((best - 1) % len(family), (best + 1) % len(family)):
        energies[number] = _energy(frame.bend(family[number]))
    return min(energies, key=energies.__getitem__)


def _energy(start: InitialGuess) -> float:
    return start.energy if np.isfinite(start.energy) else np.inf
