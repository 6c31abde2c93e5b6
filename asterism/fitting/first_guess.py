"""The first guess of a design: flattening, placement on the lattice, and star sizes from the law.

A place of the target that is `exp(-u)` times as large as on the print needs stars of that contraction. Its curvature
needs a natural curvature: if the sheet is free to bend, the sum `k1 + k2` of the principal curvatures. Gauss
curvature locks the sheet, and then the energy of a plate with Poisson's ratio nu is least for `(1 + nu)(k1 + k2)/2`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fitting.disk import TargetError
from asterism.fitting.flatten import FlatDisk, Flattener, TargetMap, least_ratio_border
from asterism.fitting.reach import StarMenu, check_size, choose_stretch, target_reach
from asterism.fitting.target import TargetSurface
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.anisotropy import BENDING_POISSON
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.design import Design, FitWeights, WeightedSite
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.stars import STAR_SIZES
from asterism.pattern.geometry.planar import cross_2d, distance_to_outline, inside
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.painted_stars import size_rows, with_painted_stars
from asterism.process.progress import Say, ignore_line
from asterism.process.settings import FitSettings
from asterism.results.records.fit import ReachRecord

# arms whose contractions frame the middle of what a target needs
MIDDLE_ARMS_MM = (3.0, 12.5)
# decimals of mm in the design
FITTED_SIZE_DECIMALS = 3


@dataclass(frozen=True, eq=False)
class FirstGuess:
    """A design from the flattening and the law alone."""

    design: Design  # with its outline, needles and star sizes
    target: TargetSurface
    target_map: TargetMap  # of the target to the print
    menu: StarMenu  # of the stretch
    reach: ReachRecord  # what the target needs and what is available


def guess_design(
    target: TargetSurface, law: StarLaw, settings: FitSettings | None = None, say: Say = ignore_line
) -> FirstGuess:
    """The first guess of a design for a target.

    The lattice of the law is that of the design. `say` is called with a line of text at the beginning of each stage.
    Raises TargetError if the flat target overlaps itself, ReachError if stars cannot make it, ForeignLaw if the law has
    no table for the stretch, and LawError if it does not cover the width, or is for unequal stretches in x and y.
    """
    if not law.even_stretches:
        raise LawError("a fit to a surface needs a law of equal stretch in x and y", field="fabric.stretch")
    say("flattening the target")
    flat = flatten_target(target)
    ranges = law.size_ranges(law.even_stretches[0])
    thinnest, widest = ranges["width_mm"]
    settings = settings or FitSettings()
    stretch, needles, width_mm = settings.stretch, settings.needles, settings.width_mm
    if width_mm is not None and not thinnest <= width_mm <= widest:
        raise LawError(f"width_mm = {width_mm:g}: the law covers {thinnest:g} to {widest:g} mm")
    # sizes that the fit does not change are the usual ones, unless the law does not cover them
    kept = {size.key: float(np.clip(size.usual, *ranges[size.key])) for size in STAR_SIZES[2:]}
    if width_mm is not None:
        kept["width_mm"] = float(width_mm)
    menus = [StarMenu.of(law, available, kept) for available in law.even_stretches]
    menu = choose_stretch(flat.ratio, menus) if stretch is None else StarMenu.of(law, stretch, kept)
    lattice = law.plan.design.lattice
    unplaced = TargetMap(flat, np.exp(_log_size(flat, menu)) * flat.points, lattice.spacing_mm)
    check_size(target.name, unplaced, menu, menus, abs(float(np.linalg.det(lattice.vectors))))
    target_map = placed(unplaced, lattice)
    outline = _choose_outline(target_map, needles)
    border = settings.border
    if border is None:
        # needles leave saddles soft
        border = needles is None and _saddle_share(target) > 0.25
    stars = _star_sites(outline.corners, lattice)
    curvatures = target_map.principal_curvatures(stars)
    is_held = border or len(outline.needles) > 0
    reach = target_reach(target.name, target_map, stars, curvatures, menu, menus, is_held, settings.nearest)
    held = "held border" if border else f"{len(outline.needles)} needles"
    say(f"{len(stars)} stars, {held}, stretch {menu.stretch:g}")
    bare = _design(target, law, menu, outline, border)
    plan = layout(bare)
    lengths, thicknesses = _sizes_from_law(target_map, menu, plan.centres).round(FITTED_SIZE_DECIMALS).T
    sizes = size_rows({"length_mm": lengths, "thickness_mm": thicknesses})
    design = _with_weights(with_painted_stars(bare, plan.sites, sizes), target, target_map, plan)
    return FirstGuess(design, target, target_map, menu, reach)


def _with_weights(design: Design, target: TargetSurface, target_map: TargetMap, plan: Layout) -> Design:
    """The design with the weights of the target at its lattice sites, so that a further fit has them too."""
    if target.weight is None:
        return design
    # decimals of a weight in a design file
    weights = target.weight_at(target_map.places(plan.lattice.place(plan.sheet_sites))).round(2)
    entries = zip(plan.sheet_sites.tolist(), weights.tolist(), strict=True)
    kept = tuple(WeightedSite(site=tuple(site), weight=weight) for site, weight in entries if weight != 1.0)
    return design.model_copy(update={"fit": FitWeights(weights=kept)})


def flatten_target(target: TargetSurface) -> FlatDisk:
    """The flattening with the smallest ratio of scale factors; TargetError if it overlaps itself."""
    flattener = Flattener(target.disk)
    # a linear programme finds the border values if Gauss curvatures of either sign have at least this share
    is_mixed = 0.1 < _saddle_share(target) < 0.9
    flat = flattener.flatten(least_ratio_border(flattener) if is_mixed else None)
    if flat.flipped or not shapely.is_valid(shapely.polygons(flat.points[target.disk.border])):
        raise TargetError(target.name, "overlaps itself when it is laid flat: cut it into parts")
    return flat


def _saddle_share(target: TargetSurface) -> float:
    """Share of negative Gauss curvature in the sum of its absolute values; 0 for developable targets."""
    gauss = target.disk.gauss_curvature
    total = float(np.abs(gauss).sum())
    return float(-gauss[gauss < 0.0].sum() / total) if total > 1e-3 else 0.0


def _sizes_from_law(target_map: TargetMap, menu: StarMenu, centres: Floats) -> Floats:
    """(S, 2) length and thickness (mm) of stars at printed centres (S, 2)."""
    contraction = np.exp(target_map.interpolate(target_map.log_contraction, centres))
    curvatures = target_map.principal_curvatures(centres)
    bend, gauss = curvatures.sum(axis=1), curvatures.prod(axis=1)
    locked = np.minimum(4.0 * np.abs(gauss) / np.maximum(bend**2, 1e-12), 1.0)
    kappa = bend * (1.0 - locked * (1.0 - 0.5 * (1.0 + BENDING_POISSON)))
    return menu.sizes(contraction, kappa)


def _log_size(flat: FlatDisk, menu: StarMenu) -> float:
    """Logarithm of the size of the print over the flat disk: the needed contractions lie in the middle of the menu."""
    ends = [int(np.abs(menu.lengths_mm - length).argmin()) for length in MIDDLE_ARMS_MM]
    contraction = menu.contraction
    columns = [contraction[end][menu.allowed[end]] for end in ends]
    middle = float(np.mean([np.log(column).mean() if len(column) else np.log(menu.range).mean() for column in columns]))
    u = flat.log_scale
    return -middle - 0.5 * float(u.max() + u.min())


def _design(target: TargetSurface, law: StarLaw, menu: StarMenu, outline: _OutlineChoice, border: bool) -> Design:
    """The design without its star sizes."""
    cell = law.plan.design.to_dict()
    data = {
        "name": _title(target.name),
        "fabric": cell["fabric"] | {"stretch": menu.stretch},
        "plastic": cell["plastic"],
        "lattice": cell["lattice"],
        "stars": {"length_mm": float(np.round(np.mean(MIDDLE_ARMS_MM), 1)), **menu.kept},
        "border": {
            "polygon_mm": outline.corners.round(FITTED_SIZE_DECIMALS).tolist(),
            "star_margin_mm": FITTED_STAR_MARGIN_MM,
        },
    }
    if border:
        places = outline.places.round(FITTED_SIZE_DECIMALS)
        data["pins"] = [{"where": "border", "target_mm": places.tolist()}]
    elif len(outline.needles):
        places = outline.places[outline.needles].round(FITTED_SIZE_DECIMALS)
        data["pins"] = [{"corners": outline.needles.tolist(), "target_mm": places.tolist()}]
    return Design.from_dict(data)


def _title(name: str) -> str:
    """The name of a design for a target: without folder and ending, in printable characters."""
    stem = name.replace("\\", "/").rsplit("/", 1)[-1].rsplit(".", 1)[0]
    kept = "".join(letter for letter in stem if letter.isprintable()).strip()
    return kept[:80] or "target"


# mm, smallest distance of star centres from the outline of a fitted design: bare rims droop between the needles
FITTED_STAR_MARGIN_MM = 3.0


def placed(start: TargetMap, lattice: Lattice) -> TargetMap:
    """The print with the turn and the shift that leave the least bare area at the rim.

    A first candidate has a star at the centre of the area, others follow in a fixed order.
    """
    ring = start.printed[start.flat.disk.border]
    band = _rim_band(ring, lattice.spacing_mm)
    centre = np.array(shapely.Polygon(ring).centroid.coords[0])
    origin = np.asarray(lattice.origin_mm)
    thirds = np.array([[1.0, 1.0], [2.0, 2.0]]) / 3.0
    # candidates: 6 turns within the symmetry of the lattice, and 4 shifts along each lattice vector
    shifts = np.array([[i, j] for i in range(4) for j in range(4)]) / 4
    best, best_score = (np.eye(2), origin - centre), np.inf
    for turn in np.arange(6) * (np.pi / 3.0 / 6):
        cos, sin = np.cos(turn), np.sin(turn)
        rotation = np.array([[cos, sin], [-sin, cos]])
        for fraction in np.concatenate([shifts, thirds]):
            shift = origin + fraction @ lattice.vectors - centre @ rotation
            score = _bare(band @ rotation + shift, ring @ rotation + shift, lattice)
            # a candidate replaces an earlier one only if it has less bare area than this share of it
            if score < 0.98 * best_score:
                best, best_score = (rotation, shift), score
    rotation, shift = best
    return replace(start, printed=start.printed @ rotation + shift)


def _star_sites(ring: Floats, lattice: Lattice) -> Floats:
    """(S, 2) mm, lattice sites within an outline (B, 2), at least `FITTED_STAR_MARGIN_MM` from it."""
    cells = lattice.sites.cells_within(ring.min(axis=0), ring.max(axis=0))
    places = lattice.sites.place(cells)
    places = places[inside(places, ring)]
    return places[distance_to_outline(places, ring) >= FITTED_STAR_MARGIN_MM]


def _bare(band: Floats, ring: Floats, lattice: Lattice) -> float:
    """Mean of the squared distance (spacings) by which places of the rim are further from all stars than others."""
    from scipy.spatial import cKDTree

    stars = _star_sites(ring, lattice)
    if not len(stars):
        return np.inf
    distance = cKDTree(stars).query(band)[0] / lattice.spacing_mm
    # of the spacing: places further than this from all stars are bare
    return float((np.maximum(distance - 0.5, 0.0) ** 2).mean())


def _rim_band(ring: Floats, spacing_mm: float) -> Floats:
    """(n, 2) mm, a grid of places within an outline and near to it."""
    step = 0.12 * spacing_mm
    axes = (np.arange(a, b, step) for a, b in zip(ring.min(axis=0), ring.max(axis=0), strict=True))
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    points = points[inside(points, ring)]
    return points[distance_to_outline(points, ring) < 0.6 * spacing_mm]


@dataclass(frozen=True, eq=False)
class _OutlineChoice:
    """The outline of a print."""

    corners: Floats  # (n, 2) mm, counterclockwise
    places: Floats  # (n, 3) mm, where the target has the corners
    needles: Ints  # (m,) numbers of the corners that needles hold


def _choose_outline(target_map: TargetMap, needles: int | None) -> _OutlineChoice:
    """The outline with its needles.

    Needles stand at the corners of the border, and between them at equal distances of about 1.6 spacings.
    With a number of needles, they stand at equal distances from a corner on; 0 gives a free sheet.
    """
    disk = target_map.flat.disk
    ring, places = target_map.printed[disk.border], disk.vertices[disk.border]
    steps = np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    total = along[-1]
    # of the spacing: window within which a corner turns
    sharp = _corners(ring, along, 0.3 * target_map.spacing_mm)
    starts = along[sharp] if len(sharp) else np.zeros(1)
    if needles:
        held = (starts[0] + np.arange(needles) * total / needles) % total
        starts = np.unique(np.concatenate([starts, held]).round(9))
    else:
        held = np.empty(0)
    gaps = np.diff(np.append(starts, starts[0] + total))
    if needles is None:
        counts = np.maximum(np.rint(gaps / (1.6 * target_map.spacing_mm)), 1).astype(int)
        if len(starts) == 1:
            counts = np.maximum(counts, 3)
        starts = np.concatenate([s + g * np.arange(n) / n for s, g, n in zip(starts, gaps, counts, strict=True)])
        held, gaps = starts, np.diff(np.append(starts, starts[0] + total))
    # of the spacing: largest distance of corners of the outline
    parts = np.maximum(np.ceil(gaps / (0.45 * target_map.spacing_mm)), 1).astype(int)
    stations = np.concatenate([s + g * np.arange(n) / n for s, g, n in zip(starts, gaps, parts, strict=True)])
    is_held = np.isin((stations % total).round(6), (held % total).round(6))
    return _OutlineChoice(_at(ring, along, stations), _at(places, along, stations), np.flatnonzero(is_held))


def _at(values: Floats, along: Floats, stations: Floats) -> Floats:
    """Values (B, k) at the vertices of a closed ring, interpolated to stations (mm) along it."""
    closed = np.concatenate([values, values[:1]])
    return np.column_stack([np.interp(stations % along[-1], along, column) for column in closed.T])


def _corners(ring: Floats, along: Floats, window: float) -> Ints:
    """Vertices of a closed border (B, 2) where it turns sharply, in order.

    The turn at a vertex is the angle between the chords to the border half a window before and behind it.
    """
    here, total = along[:-1], along[-1]
    ahead, behind = _at(ring, along, here + 0.5 * window) - ring, ring - _at(ring, along, here - 0.5 * window)
    turn = np.abs(np.arctan2(cross_2d(behind, ahead), np.einsum("nc,nc->n", behind, ahead)))
    corners: list[int] = []
    for vertex in np.argsort(-turn, kind="stable"):
        if turn[vertex] < np.deg2rad(35.0):
            break
        distance = np.abs(here[vertex] - here[corners])
        if np.minimum(distance, total - distance).min(initial=np.inf) > 2.0 * window:
            corners.append(int(vertex))
    return np.asarray(sorted(corners), dtype=np.int64)
