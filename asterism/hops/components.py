"""The components: sites, sheet, rods, exact, fit and print."""

from __future__ import annotations

import json
import threading
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.hops.parameters import InputError, Parameter, closed
from asterism.pattern.design.design import Design
from asterism.pattern.design.files import table_text
from asterism.pattern.design.material_files import material_files
from asterism.pattern.design.stars import ROD_SIZES, STAR_SIZES
from asterism.pattern.geometry.planar import dense_outline
from asterism.pattern.layout.painted_stars import with_painted_stars
from asterism.pattern.layout.star_cells import outline as outline_of
from asterism.pattern.layout.star_cells import star_cells
from asterism.previews.session import Preview
from asterism.shape.shape import Shape
from asterism.studio.file_names import check_files, file_below

# designs whose previews are kept
KEPT_PREVIEWS = 4

Values = dict[str, list[Any]]
Answer = tuple[dict[str, Any], tuple[str, ...]]


class Stopped(Exception):
    """The server ends."""


@dataclass
class Work:
    """What the components share.

    Attributes
    ----------
    folder : prints are written below it.
    patience_s : longest estimated time of an exact shape.
    stopping : when it is set, computations end at their next step.
    """

    folder: Path
    patience_s: float = 100.0
    stopping: threading.Event = field(default_factory=threading.Event)
    _previews: dict[str, Preview] = field(default_factory=dict)

    def check(self, *_: Any) -> None:
        """Raise Stopped if the server ends; called with whatever a computation reports."""
        if self.stopping.is_set():
            raise Stopped

    def preview(self, design: Design, anew: bool) -> Shape:
        """The preview of a design. Of a sheet that was shown before it follows from the last form, if not `anew`."""
        table = design.to_dict()
        key = json.dumps({name: value for name, value in table.items() if name != "stars"}, sort_keys=True)
        kept = self._previews.pop(key, None)
        if kept is None or anew:
            # wall time of the search of a preview: Hops waits for 100 s
            kept = Preview(design, check=self.check, max_seconds=90.0)
        try:
            return kept.shape() if kept.design == design else kept.update(design)
        finally:
            self._previews[key] = kept
            while len(self._previews) > KEPT_PREVIEWS:
                del self._previews[next(iter(self._previews))]

    def exact(self, design: Design) -> Shape:
        """The exact shape of a design."""
        from asterism.exact.cost import exact_cost
        from asterism.verification.simulate import simulate

        cost = exact_cost(design)
        if cost.seconds > self.patience_s:
            raise InputError(
                f"takes about {cost.in_words()}, longer than --patience {self.patience_s:g} s: use {cost.cheaper}"
            )
        return simulate(design, report=self.check, say=self.check)


@dataclass(frozen=True)
class Component:
    """A component of Grasshopper.

    `solve`: from the values of the inputs, by their names, to those of the outputs, and warnings.
    """

    name: str
    description: str
    inputs: tuple[Parameter, ...]
    outputs: tuple[Parameter, ...]
    solve: Callable[[Work, Values], Answer]


def _outline_of(corners: Floats, name: str) -> list[list[float]]:
    """The corners of a closed curve for a design, as few as a print can show."""
    try:
        ring = closed(corners)
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    # mm: corners of an outline that are nearer to the line between their neighbours are left out
    return shapely.get_coordinates(shapely.LinearRing(ring).simplify(0.05))[:-1].round(6).tolist()


def _base(values: Values) -> dict[str, Any]:
    """The table of a design with the outline and the lattice of a request."""
    border: dict[str, Any] = {"polygon_mm": _outline_of(values["outline"][0], "outline")}
    if holes := values.get("holes"):
        border["holes"] = [{"polygon_mm": _outline_of(hole, "holes")} for hole in holes]
    table: dict[str, Any] = {"name": "sheet", "border": border}
    if "arms" in values:
        table["lattice"] = {"arms": values["arms"][0]}
        if values["spacing"]:
            table["lattice"]["spacing_mm"] = values["spacing"][0]
    return table


def _star_sites(design: Design) -> Ints:
    """(n, 2) lattice sites of the sheet, in the order of the stars' numbers."""
    holes = [np.asarray(hole.polygon_mm) for hole in design.border.holes]
    return star_cells(design.border, design.lattice, outline_of(design.border, design.lattice), holes)


def _sites(work: Work, values: Values) -> Answer:
    design = Design.from_dict({**_base(values), "stars": {"length_fraction": 0.4}})
    places = design.lattice.sites.place(_star_sites(design))
    return {"sites": _in_space(places), "numbers": list(range(len(places)))}, ()


def _each(values: Values, name: str, count: int, what: str) -> list[float]:
    """An input as one number for each of some things; empty if it is not given."""
    given = values[name]
    if len(given) not in (0, 1, count):
        raise InputError(f"{name}: got {len(given)}, must be one, or one for each of the {count} {what}")
    return count * given if len(given) == 1 else given


def _sheet(work: Work, values: Values) -> Answer:
    sizes = {size.key: size.plural for size in STAR_SIZES}
    table = {**_base(values), "stars": {key: values[name][0] for key, name in sizes.items() if values[name]}}
    if values["material"]:
        name = values["material"][0]
        if name not in material_files():
            raise InputError(f"material = {name[:40]!r}: must be one of {', '.join(material_files())}")
        table["material"] = {"file": name}
    if values["stretch"]:
        table["fabric"] = {"stretch": values["stretch"][0]}
    needles, targets = values["needles"], values["targets"]
    if len(needles) != len(targets):
        raise InputError(f"targets: needs one for each of the {len(needles)} needles, got {len(targets)}")
    if needles:
        points = [needle[:2].tolist() for needle in needles]
        table["pins"] = [{"points_mm": points, "target_mm": [target.tolist() for target in targets]}]
    design = Design.from_dict(table)
    if any(len(values[name]) > 1 for name in sizes.values()):
        sites = _star_sites(design)
        lists = [_each(values, name, len(sites), "sites") or np.full(len(sites), np.nan) for name in sizes.values()]
        design = with_painted_stars(design, sites, np.column_stack(lists))
    shape = work.preview(design, anew=values["search"] == [True])
    percent = shape.summary["expected_rms_percent"]
    error = None if percent is None else 0.01 * percent * shape.summary["diameter_mm"]
    return {**_drawn(shape, design), "error": error}, _doubts(shape)


def _rods(work: Work, values: Values) -> Answer:
    curves, rods = values["curves"], []
    sections: dict[str, list[float]] = {
        size.key: _each(values, size.plural, len(curves), "curves") for size in ROD_SIZES
    }
    for number, curve in enumerate(curves):
        is_closed = len(curve) > 3 and np.allclose(curve[0], curve[-1], atol=1e-6)
        line = curve[:-1] if is_closed else curve
        own: dict[str, float] = {key: given[number] for key, given in sections.items() if given}
        rods.append({"name": f"curve {number}", "line_mm": line.tolist(), "closed": is_closed, **own})
    design = Design.from_dict({**_base(values), "fabric": {"stretch": values["stretch"][0]}, "rods": {"draw": rods}})
    shape = work.exact(design)
    return {**_drawn(shape, design), "certificate": _certificate(shape)}, _doubts(shape)


def _exact(work: Work, values: Values) -> Answer:
    design = read_design_text(values["design"][0], work.folder)
    shape = work.exact(design)
    others = [[(other.positions, other.triangles)] for other in shape.others]
    return {**_drawn(shape, design), "certificate": _certificate(shape), "others": others}, _doubts(shape)


def _fit(work: Work, values: Values) -> Answer:
    from asterism.fitting.fit import fit
    from asterism.fitting.target import TargetSurface
    from asterism.process.settings import FitSettings

    target = TargetSurface.of_triangles(*values["target"][0])
    stretch = values["stretch"][0] if values["stretch"] else None
    fitted = fit(target, FitSettings(stretch=stretch, exact=False), say=work.check)
    plan = fitted.preview.layout
    assert plan is not None
    found = {
        **dict(zip((size.plural for size in STAR_SIZES), plan.star_sizes_mm.T.tolist(), strict=True)),
        "outline": np.array(_in_space([*plan.outline, plan.outline[0]])),
        "sites": _in_space(plan.centres),
        "distance": 0.01 * fitted.summary.preview.mean_percent * fitted.summary.diameter_mm,
        "design": _text(fitted.design),
    }
    return found, tuple(map(str, fitted.summary.warnings))


def _print(work: Work, values: Values) -> Answer:
    from asterism.print.export import export

    design = read_design_text(values["design"][0], work.folder)
    folder = file_below(work.folder, values["folder"][0])
    written = export(design, folder)
    return {"paths": [str(folder / name) for name in written.files]}, written.warnings


def read_design_text(text: str, folder: Path) -> Design:
    """The design of a text in TOML, as other components write it; files that it names must lie below a folder.

    Older versions of Hops leave the text as it stands in JSON, with `\\n` for the end of a line.
    """
    if len(text) > 5_000_000:
        raise InputError("design: has more than 5000000 characters")
    try:
        if "\n" not in text and "\\n" in text:
            text = json.loads(f'"{text}"')
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"design: is not the text of a design: {error}") from None
    material = table.get("material")
    check_files(table, folder)
    if isinstance(material, dict) and isinstance(material.get("law"), str):
        file_below(folder, material["law"])
    return Design.from_dict(table, folder)


def _text(design: Design) -> str:
    return table_text(design.to_dict(), Path("design.toml"))


def _in_space(places: Any) -> list[Floats]:
    """Places (n, 2) of the print as points on the ground."""
    return list(np.pad(np.asarray(places, dtype=float), ((0, 0), (0, 1))))


def _drawn(shape: Shape, design: Design) -> dict[str, Any]:
    """Mesh, arms and rim of a shape, and the text of its design."""
    plan = shape.layout
    assert plan is not None
    rings = [dense_outline(ring) for ring in (plan.outline, *plan.holes)]
    return {
        "mesh": (shape.positions, shape.triangles),
        "arms": [shape.positions[rod] for rod in shape.rods],
        "rim": [shape.at_edges(np.concatenate([ring, ring[:1]])) for ring in rings],
        "design": _text(design),
    }


def _doubts(shape: Shape) -> tuple[str, ...]:
    lost = () if shape.summary["is_minimum"] else ("no equilibrium was found: the shape is not reliable",)
    # the next advice of a session is another one here
    followed = "the sheet followed from its last form; search = true looks for forms of lower energy"
    told = [followed if "start a new preview" in line else str(line) for line in shape.summary["warnings"]]
    return (*lost, *told)


def _certificate(shape: Shape) -> list[str]:
    return [f"{name}: {value}" for name, value in shape.summary.table().items()]


_OUTLINE = Parameter("outline", "Curve", "Closed curve around the sheet, as it lies on the printer; z is not used")
_LATTICE = (
    Parameter("holes", "Curve", "Closed curves within the outline", 0, 100),
    Parameter("spacing", "Length", "Distance of nearest stars; 17.32 mm without one", 0),
    Parameter("arms", "Integer", "Arms of a star", default=3, minimum=3, maximum=8),
)
_SECTION = "Of the plastic: one, or one for each item; {:g} mm without one"
_SIZES = tuple(Parameter(size.plural, "Length", _SECTION.format(size.usual), 0, 5000) for size in ROD_SIZES)
_TEXT = Parameter("design", "Text", "Text of the design, a file in TOML")
_SHAPE = (
    Parameter("mesh", "Mesh", "The sheet in space"),
    Parameter("arms", "Curve", "Middle lines of arms or rods, on the sheet"),
    Parameter("rim", "Curve", "The outline in space, then the edges of holes"),
)
_CERTIFICATE = Parameter("certificate", "Text", "What is known about the equilibrium, a line each")

COMPONENTS = {
    part.name: part
    for part in (
        Component(
            "sites",
            "Places of the stars on a sheet",
            (_OUTLINE, *_LATTICE),
            (Parameter("sites", "Place", "Centres of the stars"), Parameter("numbers", "Integer", "Their numbers")),
            _sites,
        ),
        Component(
            "sheet",
            "Shape of a sheet of stars, by the preview",
            (
                _OUTLINE,
                *_LATTICE,
                Parameter("lengths", "Length", "Length of the arms: one, or one for each site; 0: no star", 1, 5000),
                *_SIZES,
                Parameter("stretch", "Number", "Stretch of the fabric; 1.35 without one", 0, minimum=1.0, maximum=3.0),
                Parameter("material", "Text", "Name in the list of `asterism materials`", 0),
                Parameter("needles", "Place", "Places of needles on the print; a free sheet without them", 0, 1000),
                Parameter("targets", "Place", "Where each needle holds the sheet in space", 0, 1000),
                Parameter("search", "Boolean", "True: search all forms anew, not from the last one", 0),
            ),
            (*_SHAPE, Parameter("error", "Length", "Estimated error of the shape, rms"), _TEXT),
            _sheet,
        ),
        Component(
            "rods",
            "Shape of a sheet with drawn rods, by the exact model",
            (
                _OUTLINE,
                Parameter("curves", "Curve", "Middle lines of the rods", 1, 2000),
                *_SIZES,
                Parameter("stretch", "Number", "Stretch of the fabric", default=1.35, minimum=1.0, maximum=3.0),
            ),
            (*_SHAPE, _CERTIFICATE, _TEXT),
            _rods,
        ),
        Component(
            "exact",
            "Shape of a design, by the exact model",
            (_TEXT,),
            (*_SHAPE, _CERTIFICATE, Parameter("others", "Mesh", "Other forms of the sheet, a branch each")),
            _exact,
        ),
        Component(
            "fit",
            "Sheet of stars that comes near to a surface",
            (
                Parameter("target", "Mesh", "The surface, a mesh without holes"),
                Parameter("stretch", "Number", "Of the fabric; chosen without one", 0, minimum=1.0, maximum=3.0),
            ),
            (
                Parameter("outline", "Curve", "Outline of the sheet on the printer"),
                Parameter("sites", "Place", "Centres of the stars"),
                *(Parameter(size.plural, "Length", "Of the star at each site") for size in STAR_SIZES),
                Parameter("distance", "Length", "Mean distance of the sheet from the surface"),
                _TEXT,
            ),
            _fit,
        ),
        Component(
            "print",
            "Files for the print of a design",
            (_TEXT, Parameter("folder", "Text", "Name of a folder below that of the server")),
            (Parameter("paths", "Text", "The files"),),
            _print,
        ),
    )
}
