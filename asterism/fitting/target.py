"""The surface that a design is made for: one triangulated disk in mm, plastic side and pose chosen."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fitting.disk import Disk, TargetError, disk_of, height_mesh, place_text
from asterism.measure.scan import MAX_SCAN_COORDINATE
from asterism.pattern.design.design import WEIGHT_RANGE
from asterism.pattern.design.sizing.expression import ExpressionError, evaluate
from asterism.pattern.design.sizing.grey_image import ImageError, check_pixel_format, opened_picture
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.geometry.normals import triangle_normals, vertex_normals
from asterism.shape.surface import NearestOnSurface, self_intersections

# a fit uses the target over cells of some mm; 20 000 triangles resolve a target of 4 m to some hundredths of a cell
MAX_TARGET_TRIANGLES = 20_000
PICTURE_FORMATS = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp")
# a pixel, or a block of a field of heights, belongs to the surface if at least this part of it does
MIN_FILLED_SHARE = 0.5

PlasticSide = Literal["auto", "normals", "other"]


@dataclass(frozen=True, eq=False)
class TargetSurface:
    """A surface to make a design for.

    Attributes
    ----------
    disk : the surface, in its pose for the fit, with its normals on the plastic side.
    name : for messages and for the name of the design.
    motion : (3, 3) rotation of that pose, times the scale if the target was scaled.
    shift_mm : (3,) a point x of the file, in mm, stands at `motion @ x + shift_mm`.
    notes : what was left out or made coarser, one line each.
    weight : (V,) of the places at the vertices of the disk; None if all count alike.

    Examples
    --------
    >>> target = TargetSurface.of_formula("12*(1 - (r/50)**2)", 100.0, 80.0)
    >>> round(target.diameter_mm, 1)
    128.1
    """

    disk: Disk
    name: str
    motion: Floats
    shift_mm: Floats
    notes: tuple[str, ...] = ()
    weight: Floats | None = None

    @classmethod
    def of_triangles(
        cls,
        vertices_mm: ArrayLike,
        triangles: ArrayLike,
        name: str = "target",
        side: PlasticSide = "auto",
        size_mm: float | None = None,
    ) -> Self:
        """A target of triangles.

        Parameters
        ----------
        vertices_mm : (V, 3) mm.
        triangles : (T, 3) numbers of vertices.
        side : of the plastic. `auto`: the convex side. For surfaces without one, the upper side. `normals`: the side
            from which the first triangle runs counterclockwise; `other`: the opposite one.
        size_mm : scales the target so that the largest distance of two of its points is this long.

        Raises
        ------
        TargetError
            The triangles are not one disk, pass through each other, or have an unsuitable size.
        """
        vertices, corners = _arrays(vertices_mm, triangles, name)
        disk = disk_of(vertices, corners, name)
        flat = f"{disk.flat} triangle{'s' * (disk.flat > 1)} without area: left out" if disk.flat else ""
        disk, note = _decimated(disk, name)
        crossings = self_intersections(disk.vertices, disk.triangles)
        if crossings:
            raise TargetError(name, f"passes through itself ({crossings} crossing{'s' * (crossings > 1)})")
        scale = 1.0 if size_mm is None else size_mm / diameter(disk.vertices)
        disk = _subdivided(Disk(scale * disk.vertices, disk.triangles))
        # mm, largest distance of two points: smaller targets have no room for stars, larger ones no printer
        size, (least, most) = diameter(disk.vertices), (10.0, 4000.0)
        if not least <= size <= most:
            raise TargetError(
                name, f"is {size:.4g} mm large, allowed are {least:g} to {most:g} mm: give its unit, or its size in mm"
            )
        if side == "other" or (side == "auto" and not _is_convex_side(disk)):
            disk = disk.turned_over()
        rotation, shift = _upright_pose(disk)
        posed = Disk(disk.vertices @ rotation.T + shift, disk.triangles)
        return cls(posed, name, scale * rotation, shift, tuple(filter(None, (flat, note))))

    @classmethod
    def of_heights(
        cls,
        heights_mm: ArrayLike,
        x_mm: ArrayLike,
        y_mm: ArrayLike,
        name: str = "heights",
        side: PlasticSide = "auto",
        size_mm: float | None = None,
    ) -> Self:
        """A target of heights over a rectangular grid.

        Parameters
        ----------
        heights_mm : (m, n) heights; nan where there is no surface.
        x_mm, y_mm : (n,) and (m,), increasing.
        side, size_mm : as for `of_triangles`; the normals point upwards.

        Raises
        ------
        TargetError
            As for `of_triangles`, or the arrays do not belong together.
        """
        heights, x, y = (np.asarray(part, dtype=float) for part in (heights_mm, x_mm, y_mm))
        if x.ndim != 1 or y.ndim != 1 or heights.shape != (len(y), len(x)) or min(heights.shape) < 2:
            raise TargetError(name, f"heights of shape {heights.shape} do not fit {x.size} x and {y.size} y")
        if not ((np.diff(x) > 0).all() and (np.diff(y) > 0).all()):
            raise TargetError(name, "x and y must increase")
        return cls.of_triangles(*height_mesh(heights, x, y), name, side, size_mm)

    @classmethod
    def of_formula(cls, formula: str, width_mm: float, depth_mm: float | None = None, name: str = "formula") -> Self:
        """A target of heights in mm by a formula in x, y, r (mm) and theta, over a rectangle around the origin.

        The formula is written as for sizing profiles. `depth_mm` is `width_mm` by default.

        Raises
        ------
        TargetError
            As for `of_heights`, or the formula is not understood.
        """
        depth_mm = width_mm if depth_mm is None else depth_mm
        if not (np.isfinite([width_mm, depth_mm]).all() and min(width_mm, depth_mm) > 0.0):
            raise TargetError(name, f"a rectangle of {width_mm:g} x {depth_mm:g} mm must have positive sides")
        points = 60  # along the width
        x = np.linspace(-0.5 * width_mm, 0.5 * width_mm, points)
        y = np.linspace(-0.5 * depth_mm, 0.5 * depth_mm, max(int(points * min(depth_mm / width_mm, 4.0)), 8))
        across, along = np.meshgrid(x, y)
        return cls.of_heights(_evaluated(name, formula, {"x": across, "y": along}), x, y, name)

    def weighted(self, weight: str | Path | ArrayLike) -> Self:
        """The target with weights of its places: where they are larger, a fit comes nearer, at the cost of others.

        A fit minimises the mean over the print of `w d^2`, with the distance d to the target and the weight w of a
        place.

        Parameters
        ----------
        weight : a formula in x, y, z, r and theta (mm in the target's file), a grey picture, or (V,) numbers at the
            vertices of `disk`. A picture lies over the target as one sees it along z, its first row at the largest y;
            black is 1, white 10.

        Raises
        ------
        TargetError
            The weights are not understood, or are not from 0.01 to 100.

        Examples
        --------
        >>> target = TargetSurface.of_formula("10*(1 - (r/50)**2)", 80.0).weighted("1 + 4*(x > 0)")
        >>> target.weight_at(np.array([[-20.0, 0.0, 9.0], [20.0, 0.0, 9.0]])).tolist()
        [1.0, 5.0]
        """
        vertices = self.disk.vertices
        if isinstance(weight, str | Path):
            places = np.asarray(np.linalg.solve(self.motion, (vertices - self.shift_mm).T).T, dtype=np.float64)
            if str(weight).lower().endswith(PICTURE_FORMATS):
                values = _picture_weights(self.name, Path(weight), places[:, :2])
            else:
                values = _evaluated(self.name, str(weight), dict(zip("xyz", places.T, strict=True)), " of the weight")
        else:
            values = np.asarray(weight)
            if values.shape != (len(vertices),) or values.dtype.kind not in "iuf":
                problem = f"weights of shape {values.shape}: must be {len(vertices)} numbers, one a vertex"
                raise TargetError(self.name, problem)
        low, high = WEIGHT_RANGE
        wrong = np.flatnonzero(~((values >= low) & (values <= high)))
        if len(wrong):
            at = f"{place_text(vertices[wrong[0]])} in the pose of the fit"
            raise TargetError(self.name, f"the weight at {at} is {values[wrong[0]]:.4g}: must be {low:g} to {high:g}")
        return replace(self, weight=values.astype(float))

    @cached_property
    def diameter_mm(self) -> float:
        """Largest distance of two points of the target."""
        return diameter(self.disk.vertices)

    @cached_property
    def vertex_normals(self) -> Floats:
        """(V, 3) unit normals, on the plastic side."""
        return vertex_normals(self.disk.vertices, self.disk.triangles)

    @cached_property
    def nearest(self) -> NearestOnSurface:
        """The search for nearest points on the target; distances are positive on the plastic side."""
        return NearestOnSurface(self.disk.vertices, self.disk.triangles)

    def interpolate(self, values: Floats, points: Floats, triangle: Ints) -> Floats:
        """(n, ...) values (V, ...) of the vertices at points (n, 3) of the triangles (n,)."""
        from trimesh.triangles import points_to_barycentric  # slow to import

        corners = self.disk.triangles[triangle]
        shares = np.clip(points_to_barycentric(self.disk.vertices[corners], points, method="cross"), 0.0, 1.0)
        return np.asarray(np.einsum("nk,nk...->n...", shares, values[corners]))

    def weight_at(self, places: Floats) -> Floats:
        """(n,) weights at the points of the target that are nearest to places (n, 3) mm."""
        if self.weight is None:
            return np.ones(len(places))
        nearest = self.nearest(places)
        return self.interpolate(self.weight, nearest.places, nearest.triangle)


def _evaluated(name: str, formula: str, places: dict[str, Floats], of: str = "") -> Floats:
    """A formula at places by the names of their coordinates, and by r and theta."""
    x, y = places["x"], places["y"]
    try:
        return evaluate(formula, {**places, "r": np.hypot(x, y), "theta": np.arctan2(y, x)})
    except ExpressionError as error:
        raise TargetError(name, f"the formula{of} {error}") from None


def picture_levels(path: Path) -> Floats:
    """(m, n) grey values of a picture from 0 (black) to 1 (white), all bits of them; nan where it is transparent.

    Raises ImageError: there is no such file, it is too large, or it is not a picture.
    """
    from PIL import ImageOps  # slow to import, rarely used

    with opened_picture(path) as picture:
        check_pixel_format(picture)
        upright = ImageOps.exif_transpose(picture)
        if upright.mode.startswith("I"):
            return np.asarray(upright, dtype=float) / 65535.0
        colours = upright.convert("RGBA")
        levels = np.asarray(colours.convert("L"), dtype=float) / 255.0
        opacity = np.asarray(colours.getchannel("A"), dtype=float) / 255.0
        return np.where(opacity >= MIN_FILLED_SHARE, levels, np.nan)


def _picture_weights(name: str, path: Path, places: Floats) -> Floats:
    """(n,) weights by a picture that lies over places (n, 2)."""
    from scipy.ndimage import map_coordinates  # slow to import, rarely used

    try:
        levels = picture_levels(path)
    except ImageError as error:
        raise TargetError(name, f"the picture of the weight {error}") from None
    low, size = places.min(axis=0), np.ptp(places, axis=0)
    share = (places - low) / np.where(size > 0.0, size, 1.0)
    rows, columns = (count - 1 for count in levels.shape)
    at = np.stack([(1.0 - share[:, 1]) * rows, share[:, 0] * columns])
    grey = map_coordinates(np.nan_to_num(levels), at, order=1, mode="nearest")
    # weights of black and white of a picture; transparent pixels have that of black
    black, white = (1.0, 10.0)
    return np.asarray(black + (white - black) * np.clip(grey, 0.0, 1.0))


def _arrays(vertices: ArrayLike, triangles: ArrayLike, name: str) -> tuple[Floats, Ints]:
    points, corners = np.asarray(vertices, dtype=float), np.asarray(triangles)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise TargetError(name, "vertices must be finite numbers, shape (V, 3)")
    if np.abs(points).max(initial=0.0) > MAX_SCAN_COORDINATE:
        raise TargetError(name, f"has a vertex further than {MAX_SCAN_COORDINATE:g} mm from the origin")
    if corners.size == 0:
        raise TargetError(name, "holds no triangles: a target is a triangulated surface")
    if corners.ndim != 2 or corners.shape[1] != 3 or not np.issubdtype(corners.dtype, np.integer):
        raise TargetError(name, "triangles must be whole numbers, shape (T, 3)")
    if not 0 <= corners.min() <= corners.max() < len(points):
        raise TargetError(name, "has triangles with corners that it does not hold")
    return points, corners.astype(np.int64)


def _subdivided(disk: Disk) -> Disk:
    """The same surface with each triangle divided into four, until there are enough."""
    import trimesh  # slow to import

    vertices, triangles = disk.vertices, disk.triangles
    # a target with fewer triangles is divided: the flattening needs a mesh that resolves its curvature
    while len(triangles) < 1500:
        vertices, triangles = trimesh.remesh.subdivide(vertices, triangles)
    return Disk(np.asarray(vertices), np.asarray(triangles, dtype=np.int64))


def _is_convex_side(disk: Disk) -> bool:
    """Whether the normals are on the convex side; on the upper side, if the surface is hardly convex to either."""
    # the Laplacian of the position is the mean curvature vector, which points to the concave side
    pull = disk.laplacian @ disk.vertices
    convex = np.einsum("vc,vc->v", pull, vertex_normals(disk.vertices, disk.triangles))[disk.inner]
    # share of the sum of absolute curvatures below which neither side is the convex one
    if abs(convex.sum()) > 0.02 * np.abs(convex).sum() and abs(convex.sum()) > 1e-9:
        return bool(convex.sum() > 0.0)
    return bool(triangle_normals(disk.vertices, disk.triangles)[:, 2].sum() >= 0.0)


def _upright_pose(disk: Disk) -> tuple[Floats, Floats]:
    """Rotation (3, 3) and shift (3,) that turn the mean normal upwards by the shortest way, and centre the target."""
    normals = triangle_normals(disk.vertices, disk.triangles)
    normal, total = normals.sum(axis=0), float(np.linalg.norm(normals, axis=1).sum())
    length = float(np.linalg.norm(normal))
    rotation = _turn_to_top(normal / length) if length > 1e-6 * total else np.eye(3)
    return rotation, -(rotation @ (0.5 * (disk.vertices.min(axis=0) + disk.vertices.max(axis=0))))


def _turn_to_top(direction: Floats) -> Floats:
    """(3, 3) shortest rotation of a unit vector (3,) to the z axis; half a turn about x if it points down."""
    x, y, z = direction
    if z < -1.0 + 1e-9:
        return np.diag([1.0, -1.0, -1.0])
    if np.hypot(x, y) < 1e-6:
        return np.eye(3)
    skew = np.array([[0.0, 0.0, -x], [0.0, 0.0, -y], [x, y, 0.0]])
    return np.asarray(np.eye(3) + skew + skew @ skew / (1.0 + z))


def _decimated(disk: Disk, name: str) -> tuple[Disk, str]:
    """A disk of at most `MAX_TARGET_TRIANGLES` triangles, and a note about it; a smaller one as it is, without a note.

    Edges are collapsed in the order of their quadric errors (Garland and Heckbert 1997), by fast-simplification.
    """
    if len(disk.triangles) <= MAX_TARGET_TRIANGLES:
        return disk, ""
    from fast_simplification import simplify  # rarely used

    before = len(disk.triangles)
    triangles = disk.triangles.astype(np.int32)
    vertices, triangles = simplify(disk.vertices, triangles, target_count=MAX_TARGET_TRIANGLES)
    try:
        smaller = disk_of(np.asarray(vertices, dtype=float), np.asarray(triangles, dtype=np.int64), name)
    except TargetError:
        raise TargetError(name, f"has {before} triangles and cannot be decimated: simplify it") from None
    some = disk.vertices[:: max(len(disk.vertices) // 20_000, 1)]
    moved = np.abs(NearestOnSurface(smaller.vertices, smaller.triangles)(some).distance).max()
    after = len(smaller.triangles)
    return smaller, f"{before} triangles are decimated to {after}, which moves the surface by at most {moved:.2g} mm"
