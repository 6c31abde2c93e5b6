"""Initial guesses: simple shapes on the supports, and the one of lowest energy of every kind.

**A guess** is a simple shape that is bent, placed on the supports, and relaxed in plane. An in-plane relaxation moves
the printed plane within itself before it is bent. Its displacement solves the linear membrane problem of the flat sheet
for the membrane strains of the bent one. A sheet that is fixed at a point or a line rotates rigidly first, until its
dead loads are in equilibrium. Newton's method moves points along straight lines, so a large rotation would stretch the
sheet on its way.

**Directions.** The energy of a uniformly bent sheet depends on the direction. It has a local minimum at each axis of
the lattice, and these minima are about equally low. The equilibria alone decide which axis suits the outline and the
variation of the fields, so each axis gives a guess, except those that the symmetry of the sheet makes equal.

**Candidates** are simple shapes that suit the mean fields. A rest metric `lambda^2 I` has the Gaussian curvature `K =
-lap(ln lambda)/lambda^2`. A sheet keeps its rest lengths if the product of its principal curvatures is K (Gauss). Among
these shapes a plate with Poisson's ratio nu and rest curvature kappa has the least bending energy if their sum is `(1 +
nu) kappa`:

- K = 0 gives an arc of curvature `(1 + nu) kappa`;
- other K give a saddle or a shape bent both ways, as long as real principal curvatures exist;
- otherwise the best shape is a round cap of curvature `sqrt(K)`.

Thick sheets stretch rather than bend. Therefore smaller K are candidates too, and caps of the rest curvature itself. A
sheet that is longer than the frame of its supports has caps of its own length as further candidates. The sign of kappa
gives the side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.sparse_pattern import stiffen
from asterism.fem.elements.argyris import Evaluation
from asterism.fem.search.mean_fields import MeanFields, Side, check_side, mean_fields
from asterism.fem.search.simple_shapes import Plane, SimpleShape, similar
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.rigid import span_a_plane

RANK_TOLERANCE = 1e-9  # 1: singular value over the largest, below which it is zero (points on a line, parallel loads)


@dataclass(frozen=True)
class InitialGuess:
    """A simple shape, the state x (N, 3) in mm made of it, and its energy in N mm."""

    shape: SimpleShape
    x: Floats
    energy: float


class GuessBuilder:
    """Builds initial guesses for one shell, and keeps them: every shape is bent once.

    Parameters
    ----------
    factor : of the shell; holds the stiffness of the flat sheet after the first guess that needs it.
    centre, stretch : (2,) mm and a factor: the plane that is bent, see `fem.search.simple_shapes.similar`.
    """

    def __init__(self, shell: Shell, factor: Factor, centre: Floats, stretch: float) -> None:
        self._shell, self._factor = shell, factor
        self._plane = similar(centre, stretch)
        self._located: dict[bytes, tuple[Floats, Evaluation]] = {}
        self._bent: dict[SimpleShape, InitialGuess] = {}

    @cached_property
    def _ready(self) -> bool:
        """Whether the factor holds the stiffness of the flat sheet; computed at the first use."""
        shell = self._shell
        data = shell.flat_stiffness.copy()
        stiffen(shell.pattern, data, shell.support(shell.flat))
        return self._factor.factorise(data)

    @cached_property
    def _rotation(self) -> Floats | None:
        """(3, 3) rotation from the printed to the target positions of the supports; None for the identity.

        Points on one line without a clamp leave the rotation about this line undetermined; the smallest one is used.
        """
        fixed, reduction = self._shell.fixed_points, self._shell.reduction
        places = reduction.offset(self._shell.progress).reshape(-1, 3)[fixed]
        printed, places = (at - at.mean(axis=0) for at in (self._shell.flat[fixed], places))
        if len(reduction.normals):
            up = np.full(reduction.normals.shape, self._shell.extent) * [0.0, 0.0, 1.0]
            printed = np.concatenate([printed, up])
            places = np.concatenate([places, self._shell.extent * reduction.normals])
        elif not span_a_plane(places):
            farthest = np.linalg.norm(printed, axis=1).argmax()
            printed, places = printed[farthest], places[farthest]
            if not (printed.any() and places.any()):
                return None
        rotation = Rotation.align_vectors(places, printed)[0].as_matrix()
        # largest difference from the identity of a rotation that counts as the identity
        return None if np.abs(rotation - np.eye(3)).max() < 1e-6 else np.asarray(rotation)

    def bend(self, shape: SimpleShape) -> InitialGuess:
        """The guess of a shape on the supports."""
        if shape not in self._bent:
            x = self._on_supports(shape.over(self._shell.space, self._plane))
            self._bent[shape] = InitialGuess(shape, x, self._shell.energy(x))
        return self._bent[shape]

    def relax_in_plane(self, guess: InitialGuess, energy_limit: float = np.inf) -> InitialGuess:
        """The guess after in-plane relaxation; it stops early if the energy cannot come below `energy_limit` N mm."""
        shell, shape = self._shell, guess.shape
        moves = np.zeros_like(shell.flat)
        # in-plane relaxations of a guess
        for _ in range(3 if self._ready else 0):
            strains = shell.strains(guess.x)
            strains[..., 3:] = 0.0
            stress = shell.linear_stress(strains)
            stress[..., 3:] = 0.0
            forces = shell.restrict(shell.assembly.forces(shell.flat, stress))
            moves = shell.move(moves, -self._factor.solve(forces))
            x = self._on_supports(shape.over(shell.space, self._moved(moves)))
            trial = InitialGuess(shape, x, shell.energy(x))
            if not trial.energy < guess.energy:
                break
            gain = guess.energy - trial.energy
            # gain of a step over the energy, below which it is the last step
            is_last = gain < 0.1 * abs(guess.energy)
            guess = trial
            # gain of all later steps over that of a step; usually each gains a fifth of the one before
            if is_last or guess.energy - 0.25 * gain > energy_limit:
                break
        return guess

    def _moved(self, moves: Floats) -> Plane:
        """The plane after displacements (N, 3) mm within it."""

        def plane(points: Floats) -> Floats:
            key = points.tobytes()
            if key not in self._located:
                self._located[key] = self._plane(points), self._shell.space.locate(points)
            places, at = self._located[key]
            return places + at.jets(moves[:, :2])

        return plane

    def _on_supports(self, x: Floats) -> Floats:
        """(N, 3) the state x on the supports: moved rigidly, deformed like the flat sheet, settled under loads."""
        shell = self._shell
        if shell.is_free:
            return x
        fixed = shell.fixed_points
        if len(fixed):
            x = x if self._rotation is None else shell.translated(x @ self._rotation.T, np.zeros(3))
            places = shell.reduction.offset(shell.progress).reshape(-1, 3)
            x = shell.translated(x, places[fixed].mean(axis=0) - x[fixed].mean(axis=0))
        supported = shell.constrain(x)
        if not self._ready:
            return settle_rigid_body(shell, supported)
        return settle_rigid_body(shell, shell.move(supported, -self._factor.solve(shell.flat_forces(supported - x))))


def settle_rigid_body(shell: Shell, x: Floats) -> Floats:
    """(N, 3) the state x after the rotation that maximises the work of the dead loads; x if it cannot rotate.

    Both x and the result meet the supports.
    """
    places = x[shell.fixed_points]
    if not shell.loads.any() or not len(places) or span_a_plane(places):
        return x
    free = shell.rigid_motions(x).shape[1]
    pivot = places.mean(axis=0)
    arms = shell.translated(x, -pivot)
    _, sizes, axes = np.linalg.svd(places - pivot)
    if free == 1 and sizes[0] > RANK_TOLERANCE * shell.extent:
        rotation = _about_line(arms, shell.loads, axes[0])
    elif free == 3 and sizes[0] <= RANK_TOLERANCE * shell.extent:
        rotation = _about_point(arms, shell.loads)
    else:
        return x  # other supports fix some components
    return shell.translated(arms @ rotation.T, pivot)


def _about_line(arms: Floats, loads: Floats, axis: Floats) -> Floats:
    """(3, 3) the rotation about an axis that maximises the work of the loads on points at arms (N, 3) mm."""
    across = arms - np.outer(arms @ axis, axis)
    along, aside = float((loads * across).sum()), float((loads * np.cross(axis, across)).sum())
    return np.asarray(Rotation.from_rotvec(np.arctan2(aside, along) * axis).as_matrix())


def _about_point(arms: Floats, loads: Floats) -> Floats:
    """(3, 3) the rotation about a point that maximises the work of the loads (Kabsch 1976)."""
    u, sizes, vt = np.linalg.svd(arms.T @ loads)
    if sizes[1] <= RANK_TOLERANCE * sizes[0]:  # all loads are parallel
        return np.asarray(Rotation.align_vectors(vt[0], u[:, 0])[0].as_matrix()) if sizes[0] > 0.0 else np.eye(3)
    vt[-1] *= np.sign(np.linalg.det(u @ vt))
    return np.asarray((u @ vt).T)


# 1: energy of a supported guess over that of the best one, beyond which it is left out; with 6 it may still be the best
MAX_ENERGY_RATIO = 8.0
SYMMETRY_BREAKING_ANGLE = np.radians(8.0)  # rad, from an axis of symmetry, which may be a saddle
MIN_TURN = 0.02  # rad from end to end, below which a shape counts as flat
MAX_TURN_ACROSS = 2.0  # rad from end to end, for caps and for the second principal direction


def initial_guesses(
    shell: Shell,
    factor: Factor,
    side: Side = "auto",
    candidates: list[SimpleShape] | None = None,
    symmetries: Sequence[Floats] = (),
) -> tuple[list[InitialGuess], list[InitialGuess]]:
    """The best guess of every kind, and the guesses of the best kind in other directions; all meet the supports.

    Both lists are sorted by energy. Guesses far above the best one are left out without in-plane relaxation.

    Parameters
    ----------
    factor : of `shell.factor()`; it holds another matrix afterwards.
    side : side of the edges; by default that of the rest curvature.
    candidates : shapes that are compared; by default those of `candidate_shapes`.
    symmetries : see `distinct_shapes`.
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
        # energies of the flat sheet, an upper bound of the gain by in-plane relaxation
        self._excess = 20.0 * shell.energies(shell.constrain(shell.flat))["sheet"]
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


def energy_minima(shell: Shell, stretch: float, family: Sequence[SimpleShape]) -> list[SimpleShape]:
    """Shapes at the local minima of the energy over the angle, the lowest first.

    If all energies are equal there is one shape, away from the axes of symmetry.

    Parameters
    ----------
    stretch : length of the bent sheet over its printed length.
    family : shapes that differ only in their angle; the angles are equally spaced over half a turn.
    """
    energies = np.array([_uniform_energy(shell, stretch, shape) for shape in family])
    # relative difference below which energies count as equal
    if np.ptp(energies) <= 1e-3 * abs(energies.min()):
        # an axis of symmetry may be a saddle, from which the search would have to depart
        return [replace(family[int(energies.argmin())], angle=SYMMETRY_BREAKING_ANGLE)]
    low = (energies <= np.roll(energies, 1)) & (energies < np.roll(energies, -1))
    low[energies.argmin()] = True
    return [family[number] for number in np.argsort(energies) if low[number]]


def distinct_shapes(
    first: SimpleShape, others: Sequence[SimpleShape], symmetries: Sequence[Floats]
) -> list[SimpleShape]:
    """The shapes in `others` that no symmetry maps onto `first` or onto an earlier one.

    `symmetries`: rotations and reflections (2, 2) of the print that leave outline, supports and fields unchanged.
    """
    kept = [first]
    for shape in others:
        images = [_image_angle(shape.angle, symmetry) for symmetry in (np.eye(2), *symmetries)]
        # rad, difference below which two axes count as equal
        if all(_line_angle(image, shape_kept.angle) > np.radians(1.0) for image in images for shape_kept in kept):
            kept.append(shape)
    return kept[1:]


def _uniform_energy(shell: Shell, stretch: float, shape: SimpleShape) -> float:
    """Energy in N mm of a sheet with the curvatures of the shape at every point."""
    c, s = np.cos(shape.angle), np.sin(shape.angle)
    k, m = shape.curvature, shape.across
    bend = np.array([k * c * c + m * s * s, k * s * s + m * c * c, 2.0 * (k - m) * c * s])
    strains = np.concatenate([[0.5, 0.5, 0.0], bend]) * stretch**2 - shell.rest
    return float((shell.assembly.weights * shell.density.energies(strains)).sum())


def _image_angle(angle: float, symmetry: Floats) -> float:
    """Angle of a direction after a rotation or reflection (2, 2)."""
    x, y = symmetry @ np.array([np.cos(angle), np.sin(angle)])
    return float(np.arctan2(y, x))


def _line_angle(first: float, second: float) -> float:
    """Angle between two lines, 0 to pi/2, from their directions."""
    return float(abs((first - second + 0.5 * np.pi) % np.pi - 0.5 * np.pi))


def candidate_shapes(fields: MeanFields, size: float, side: Side = "auto") -> list[SimpleShape]:
    """Candidates for a sheet whose printed size is `size` mm, on a side of the printed plane.

    Raises `ValueError` if the side is none of `auto`, `up`, `down`.

    >>> import numpy as np
    >>> fields = MeanFields(np.zeros(2), stretch=0.8, gaussian=0.0, curvature=0.01, poisson=0.3, chord=np.inf)
    >>> sorted({shape.name for shape in candidate_shapes(fields, size=60.0)})
    ['arc', 'cap', 'flat']
    """
    check_side(side)
    length = size * fields.stretch
    sign = 1.0 if (fields.side if side == "auto" else side) == "up" else -1.0
    bend = abs(fields.curvature)
    out = [SimpleShape("flat")]
    caps = [0.5 * bend, bend]
    if fields.chord < fields.stretch:
        angle = 2.0 * _arc_angle(fields.chord / fields.stretch)
        caps += [angle / length, 0.5 * angle / length]
    # Gaussian curvature times size squared, below which a rest metric counts as flat
    is_flat = abs(fields.gaussian) * length**2 < 1e-2
    for share in (0.0,) if is_flat else (1.0, 0.5, 0.0):
        product = share * fields.gaussian
        half = 0.5 * (1.0 + fields.poisson) * bend
        if product > 0.0 and (share == 1.0 or half**2 < product):
            caps.append(np.sqrt(product))
        if half**2 < product:
            continue
        root = np.sqrt(half**2 - product)
        larger, smaller = half + root, half - root
        name = "saddle" if smaller * length < -MIN_TURN else "bent" if smaller * length > MIN_TURN else "arc"
        if larger * length > MIN_TURN:
            k = sign * min(larger, 6.0 / length)  # rad from end to end; a larger angle may lead to self-intersection
            m = sign * float(np.clip(smaller, -MAX_TURN_ACROSS / length, MAX_TURN_ACROSS / length))
            # the six axes of a hexagonal lattice and the directions halfway between them
            angles = np.pi * np.arange(12) / 12
            out += [SimpleShape(name, k, angle, 0.0 if name == "arc" else m) for angle in angles]
    out += [SimpleShape("cap", sign * min(k, MAX_TURN_ACROSS / length)) for k in caps if k * length > MIN_TURN]
    return list(dict.fromkeys(out))  # the limits may make shapes equal


def _arc_angle(ratio: float) -> float:
    """Half of the angle of an arc whose chord is `ratio` times its length."""
    low, high = 0.0, np.pi
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.sinc(middle / np.pi) > ratio else (low, middle)
    return low
