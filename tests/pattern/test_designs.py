"""Whatever is wrong with a design ends as one line that names the place; good ones survive a round trip.

The reference of the design file names every key.
"""

import copy
import json
import re
from pathlib import Path
from typing import get_args

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from pydantic import BaseModel

from asterism.pattern.design.design import Design, save_design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.sizing.profiles import MARKED_PROFILES, NAMED_PROFILES
from asterism.pattern.design.stars import Override
from asterism.pattern.layout.build import layout, load_design

GOOD = {"stars": {"length_mm": 10.0}, "border": {"rings": 1}}
RADIAL = {"profile": "radial", "from": 10, "to": 4, "over_mm": 50}
STRAIGHT = {"profile": "linear", "from": 1, "to": 2, "start_mm": [0, 0], "end_mm": [0, 0]}
TABLE = {"profile": "table", "distance_mm": [0, 1], "values": [1, 2, 3]}
IMAGE = {"image": "none.png", "low": 1, "high": 2, "extent_mm": [9, 9]}
SQUARE = {"rectangle_mm": [100, 100]}
FALLING = {"thickness_mm": [0.4, 0.3], "per_mm": [0.1, 0.1]}
CORNERS = {"polygon_mm": [[0, 0], [90, 0], [90, 90], [0, 90]]}
DELETE = b"take it out"  # no design has bytes in it; equal in every test process


def changed(*changes):
    """The good design with values put at dotted places."""
    design = copy.deepcopy(GOOD)
    for place, value in changes:
        *tables, key = place.split(".")
        table = design
        for name in tables:
            table = table.setdefault(name, {})
        if value == DELETE:
            del table[key]
        elif isinstance(table, dict):
            table[key] = value
    return design


def thin(tip: float) -> dict[str, list[list[float]]]:
    """A square with a spike or a slit, 0.002 mm thin."""
    return {"polygon_mm": [[0, 0], [90, 0], [90, 40], [tip, 40.001], [90, 40.002], [90, 90], [0, 90]]}


# what is changed; the field the message must name; words it must hold
BAD = [
    ([("stars.length_mm", "long")], "stars.length_mm", "number"),
    ([("stars.length_mm", "7.5")], "stars.length_mm", "numbers have no quotes"),
    ([("stars.length_mm", "4 + r / 20")], "stars.length_mm", 'a formula is written { formula = "..." }'),
    ([("stars.length_mm", True)], "stars.length_mm", "number"),
    ([("stars.length_mm", 25)], "stars.length_mm", "from 0 to 17.3205 at star 0"),
    ([("stars.length_mm", float("nan"))], "stars.length_mm", "finite"),
    ([("stars.length_mm", 10**400)], "stars.length_mm", "number"),
    ([("name", 101 * "a")], "name", "at most 100 characters"),
    ([("spread.modulus_ratio_factor", 0.9)], "spread.modulus_ratio_factor", "at least 1"),
    ([("spread.thickness_mm", 0.1)], "spread.thickness_mm", "it belongs in [fabric] or in [stars]"),
    ([("stars.length_mm", None), ("stars.length_fraction", 1.5)], "stars.length_fraction", "from 0 to 1"),
    ([("stars.length_fraction", 0.5)], "stars", "one of length_mm and length_fraction, but has length_mm and"),
    ([("pins", [{"scale": 0.7}])], "pins[0]", "one of where, points_mm, edges, corners and holes"),
    ([("lattice", {"vectors_mm": [[9, 0], [0, 9]]})], "lattice.vectors_mm", 'kind = "custom", not with "triangular"'),
    ([("stars.length_mm", DELETE)], "stars", "one of length_mm and length_fraction"),
    ([("stars.length_mm", 0.5)], "stars", "at least one arm of 1 mm on the sheet; the longest of the design is 0.5 mm"),
    ([("stars.length_mm", 17.32)], "stars", "shorten or turn them; length_fraction makes ends meet"),
    ([("stars.lenght_mm", 3)], "stars.lenght_mm", "did you mean length_mm?"),
    ([("stars.thickness_mm", 6)], "stars.thickness_mm", "from 0.05 to 5"),
    ([("stars.thickness_mm", {**RADIAL, "to": -4})], "stars.thickness_mm", "star"),
    ([("stars.width_mm", 11)], "stars.width_mm", "from 0.1 to 10"),
    ([("stars.vary_along_arms", 1)], "stars.vary_along_arms", "true or false"),
    ([("stars.length_mm", {"profile": "conic"})], "stars.length_mm.profile", "axis, linear, radial, table"),
    ([("stars.length_mm", {"profile": "radial", "from": 1, "to": 2})], "stars.length_mm.over_mm", "missing"),
    ([("stars.length_mm", {**RADIAL, "over_mm": 0})], "stars.length_mm.over_mm", "greater than 0"),
    ([("stars.length_mm", STRAIGHT)], "stars.length_mm.end_mm", "differ"),
    ([("stars.length_mm", TABLE)], "stars.length_mm.values", "2 entries"),
    ([("stars.length_mm", {**TABLE, "distance_mm": [0, 1e-300, 1]})], "stars.length_mm.distance_mm", "by 1e-6 or more"),
    ([("stars.length_mm", {"formula": "import os"})], "stars.length_mm.formula", "not a formula"),
    ([("stars.length_mm", {"formula": "1/x"})], "stars.length_mm", "inf"),
    ([("stars.length_mm", IMAGE)], "stars.length_mm.image", "no such file"),
    ([("stars.length_mm", {**IMAGE, "pixels": [2, 2], "grey": "eJwDAA=="})], "stars.length_mm.grey", "pixels"),
    ([("stars.override", [{"star": 7, "remove": True}])], "stars.override[0].star", "at most 6"),
    ([("stars.override", [{"star": 1}])], "stars.override[0]", "change a size or remove"),
    ([("stars.override", [{"at_mm": [5, 5], "remove": True}])], "stars.override[0].at_mm", "nearest is at"),
    ([("stars.override", [{"star": 0, "length_mm": 30}])], "stars.override[0].length_mm", "from 0 to 17.3205"),
    ([("stars.override", [{"at_mm": [1e200, 0], "remove": True}])], "stars.override[0].at_mm[0]", "at most 1e+12"),
    ([("border.rings", DELETE)], "border", "one of rings, rectangle_mm, polygon_mm, circle_mm, spline_mm and rods"),
    ([("border.rings", 41)], "border.rings", "at most 40"),
    ([("border.star_margin_mm", 5)], "border.star_margin_mm", "not with rings"),
    ([("border", {"rectangle_mm": [100, -5]})], "border.rectangle_mm", "from 1 to 5000"),
    ([("border", {"rectangle_mm": [100]})], "border.rectangle_mm[1]", "missing"),
    ([("border", {"rectangle_mm": [5, 5]})], "border", "room for at least one star"),
    ([("border", {"rectangle_mm": [2000, 2000]}), ("mesh.edge_mm", 10)], "border", "at most 5000 stars"),
    ([("border", {"rectangle_mm": [5000, 5000]}), ("lattice.spacing_mm", 8)], "border", "at most 5000 stars"),
    ([("border", {**SQUARE, "star_margin_mm": 1, "tip_margin_mm": 2})], "border.star_margin_mm", "exceed"),
    ([("border", {"polygon_mm": [[0, 0], [50, 0]]})], "border.polygon_mm", "at least 3"),
    ([("border", {"polygon_mm": [[0, 0], [90, 0], [0, 90], [0, 0]]})], "border.polygon_mm", "repeat"),
    ([("border", {"polygon_mm": [[0, 0], [90, 0], [180, 0]]})], "border.polygon_mm", "lie on one line"),
    ([("border", {"polygon_mm": [[0, 0], [90, 90], [90, 0], [0, 90]]})], "border.polygon_mm", "at [45.000, 45.000]"),
    *(([("border", thin(tip))], "border.polygon_mm", "spike or slit at [90, 40]") for tip in (150.0, 30.0)),
    ([("plastic.modulus_mpa", 3000)], "plastic.modulus_mpa", "use modulus_ratio"),
    ([("border", {"polygon_mm": [[0, 0], [90, 0], [0, 9e9]]})], "border.polygon_mm", "within 5000"),
    ([("border", {"polygon_mm": [[0, 0], [90, 0], [0, float("inf")]]})], "border.polygon_mm[2][1]", "finite"),
    ([("border", {**CORNERS, "bulge_mm": [1, 2, 3]})], "border.bulge_mm", "4 entries, one for each edge"),
    ([("border", {**CORNERS, "bulge_mm": [0, 0, -46, 0]})], "border.bulge_mm[2]", "within 45 mm, half the length"),
    ([("border", {**CORNERS, "bulge_mm": [0, float("nan"), 0, 0]})], "border.bulge_mm[1]", "finite"),
    ([("border", {**CORNERS, "bulge_mm": [-45, -45, 0, 0]})], "border.bulge_mm", "not cross or touch itself, as at"),
    ([("border.bulge_mm", [1, 2, 3])], "border.bulge_mm", "goes with polygon_mm"),
    (
        [("border", {"polygon_mm": [[-50, 0], [50, 0], [0, 5]], "bulge_mm": [-50, 0, 0]})],
        "border.bulge_mm",
        "beyond the opposite corners",
    ),
    ([("border", {"spline_mm": [[0, 0], [90, 0]]})], "border.spline_mm", "at least 3"),
    ([("border", {"spline_mm": [[0, 0], [90, 0], [180, 0]]})], "border.spline_mm", "lie on one line"),
    ([("border", {"spline_mm": [[0, 0], [90, 90], [90, 0], [0, 90]]})], "border.spline_mm", "at [45.000, 45.000]"),
    ([("border", {"circle_mm": {"radius": [50, 30], "turn_deg": 400}})], "border.circle_mm.turn_deg", "at most 360"),
    ([("border", {"circle_mm": {"radius": [5010, 3000], "turn_deg": 1}})], "border.circle_mm", "within 5000"),
    ([("border", 3)], "border", "table"),
    ([("lattice.arms", 9)], "lattice.arms", "at most 8"),
    ([("lattice.kind", "hexagonal")], "lattice.kind", "'triangular', 'square' or 'custom'"),
    ([("lattice.kind", "square")], "border.rings", "triangular"),
    ([("lattice.origin_mm", [1, 0])], "lattice.origin_mm", "[0, 0]"),
    ([("lattice.kind", "custom")], "lattice.vectors_mm", 'is missing: kind = "custom" needs two'),
    ([("lattice", {"kind": "custom", "vectors_mm": [[9, 0], [18, 0]]})], "lattice.vectors_mm", "line"),
    ([("lattice", {"kind": "custom", "vectors_mm": [[0.1, 0], [0, 99]]})], "lattice.vectors_mm", "1 mm between"),
    ([("fabric.stretch", [1.3, 3.5])], "fabric.stretch", "from 1 to 3"),
    ([("fabric.modulus_mpa", [7, 0])], "fabric.modulus_mpa", "from 0.001 to 100000"),
    ([("fabric.modulus_mpa", [1, 9])], "fabric.modulus_mpa", "ratio of at most 4.78 with poisson = 0.3"),
    ([("fabric.modulus_mpa", [8, 4]), ("fabric.model", "incompressible")], "fabric.model", "neo-hookean"),
    ([("fabric.modulus_mpa", [8, 4]), ("fabric.bending", "paper")], "fabric.bending", "consistent"),
    ([("fabric.modulus_mpa", [8, 4]), ("fabric.shear_modulus_mpa", 0.1)], "fabric.shear_modulus_mpa", "0.577 to 2.53"),
    ([("fabric", {"bending": "paper", "bending_stiffness_n_mm": 1})], "fabric.bending_stiffness_n_mm", "needs fabric"),
    ([("fabric.bending_stiffness_n_mm", 1)], "fabric.modulus_mpa", "bending_stiffness_n_mm"),
    ([("fabric.poisson", 0.5)], "fabric.poisson", "at most 0.49"),
    ([("plastic.kappa_bar_per_mm", 2)], "plastic.kappa_bar_per_mm", "at most 1"),
    (
        [("plastic.kappa_bar_per_mm", {"thickness_mm": [0.3, 0.4], "per_mm": [0.1]})],
        "plastic.kappa_bar_per_mm.per_mm",
        "2 entries",
    ),
    ([("pins", [{"edges": [6]}])], "pins[0].edges[0]", "from 0 to 5"),
    ([("pins", [{"corners": [0, 0]}])], "pins[0].corners[1]", "twice"),
    ([("pins", [{"where": "border"}, {"where": "corners"}])], "pins[1]", "holds already"),
    ([("pins", [{"edges": [1, 2]}, {"edges": [2, 3]}])], "pins[1]", "edge 2"),
    ([("pins", [{"where": "corners", "target_mm": [0, 0, 0]}])], "pins[0].target_mm", "6 places"),
    ([("pins", [{"corners": [0], "target_mm": [0, 0, 0], "scale": 2}])], "pins[0].target_mm", "alone"),
    ([("pins", [{"corners": [0], "offset_mm": [0, 0, 1e9]}])], "pins[0].offset_mm", "within 10000"),
    ([("gravity.on", True)], "fabric.modulus_mpa", "gravity"),
    ([("gravity.direction", [0, 0, 0])], "gravity.direction", "somewhere"),
    ([("mesh.graded", True), ("fabric.bending", "paper")], "mesh.graded", "plate"),
    ([("mesh.edge_mm", 0.1)], "mesh.edge_mm", "at least 0.2"),
    ([("mesh.edge_mm", 30)], "mesh.edge_mm", "spacing"),
    ([("border.rings", 30), ("mesh.edge_mm", 0.5)], "mesh.edge_mm", "or more"),
    ([("units", "inch")], "units", 'must be "mm": write all lengths in millimetres'),
    ([("plastic.kappa_bar_per_mm", FALLING)], "plastic.kappa_bar_per_mm.thickness_mm", "increase"),
    ([("pins", {"where": "corners"})], "pins", "must be a list; a table in it begins with [[pins]]"),
    ([("border", {"rectangle_mm": [15, 0, 18, 0]})], "border.rectangle_mm", "at most 2 entries; decimals have a point"),
    ([("stars.length_mm", {"formula": "6 + r^2/1000"})], "stars.length_mm.formula", "powers are **"),
    ([("name", "two\nlines")], "name", "one line"),
    ([("lattice", {"origin_mm": [1e9, 0]})], "lattice.origin_mm", "within 10000 mm"),
    ([("pins", [{"points_mm": [[0, 0], [9, 0]], "target_mm": 2 * [[0, 0, 1]]}])], "pins[0].target_mm", "one place"),
    ([("zzz", {})], "zzz", "known here: name, units"),
    ([("stars.spacing_mm", 20)], "stars.spacing_mm", "unknown key here, it belongs in [lattice]"),
    ([("stars.poisson", 0.3)], "stars.poisson", "it belongs in [fabric] or in [plastic]"),
    ([("stretch", 1.3)], "stretch", "it belongs in [fabric]"),
    ([("mesh.name", "roof")], "mesh.name", "it belongs at the top, before all tables"),
]


@pytest.mark.parametrize(("changes", "field", "words"), BAD, ids=lambda value: str(value)[:50])
def test_bad_design(changes, field, words):
    with pytest.raises(DesignError) as caught:
        layout(Design.from_dict(changed(*changes)))
    assert caught.value.field == field
    assert words in str(caught.value)
    assert str(caught.value).isprintable() and len(str(caught.value)) < 400


BAD_FILES = [
    ("a.toml", None, "No such file"),
    ("a.txt", "", "must end in .toml or .json"),
    ("a.toml", "", "is empty"),
    ("a.json", " \n ", "is empty"),
    ("a.toml", b"name = '\xff'", "is not UTF-8"),
    ("a.toml", "name = 'a'\nname\n", "line 2"),
    ("a.toml", "name = 'a'\nname = 'b'\n", "line 2"),
    ("a.json", "{\n 'a'", "line 2"),
    ("a.json", '{"name": "a", "name": "b"}', "'name' is there twice"),
    ("a.json", "[]", "must hold a table"),
    ("a.json", "{}", "border: is missing"),
    ("a.json", '{"name": "\\ud800"}', "half a character"),
    ("a.json", '{"\\udfff": 1}', "half a character"),
    ("a.json", '{"stars": {"length_mm": {"image": "\\ud800"}}}', "half a character"),
    ("a.json", "[" * 100_000, "nested too deeply"),
    ("a.toml", "a = " + "[" * 100_000, "nested too deeply"),
    ("a.toml", ".".join(3000 * "a") + " = 1", "nested too deeply"),
    ("a.toml", "a = " + "[" * 200 + "]" * 200, "nested too deeply"),
    ("a.toml", "mesh = " + "9" * 5000, "is not TOML"),
    ("a.toml", "mesh = 0x" + "f" * 5000, "a whole number has too many digits"),
    ("a.toml", "[stars]\nlength_mm = 7,5", "decimals have a point"),
    ("a.toml", "[stars]\nlength_mm = 7\nlength_mm = 8", "each key and each table may stand once"),
    ("a.toml", "[stars]\nlength_mm = 7\n[stars]\nwidth_mm = 1", "each key and each table may stand once"),
    ("a.toml", '[stars]\nlength_mm = 7\n[border]\nfile = "C:\\users\\new\\leaf.svg"\n', "write paths with /"),
    ("a.toml", "#" * 10_000_001, "larger than 10 MB"),
    ("a.json", json.dumps({**GOOD, "mesh": {"edge_mm": 40}}), "mesh.edge_mm = 40.0: must be at most"),
    ("a.json", '{"stars": {"length_mm": NaN}, "border": {"rings": 1}}', "stars.length_mm = nan: must be a finite"),
]


@pytest.mark.parametrize(("name", "content", "words"), BAD_FILES, ids=lambda value: str(value)[:30])
def test_bad_file(tmp_path, name, content, words):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(DesignError) as caught:
        load_design(path)
    assert str(caught.value).startswith(f"{path}: ") and words in str(caught.value)
    assert str(caught.value).isprintable()


@pytest.mark.parametrize("data", [None, 3, "x", []])
def test_data_must_be_a_table(data):
    with pytest.raises(DesignError, match="table"):
        Design.from_dict(data)


def test_folder_is_not_a_file(tmp_path):
    (tmp_path / "a.toml").mkdir()
    with pytest.raises(DesignError) as caught:
        load_design(tmp_path / "a.toml")
    assert str(caught.value) == f"{tmp_path / 'a.toml'}: is a folder, not a file"


numbers = st.integers() | st.floats() | st.booleans()
values = st.recursive(
    st.none()
    | numbers
    | st.text(max_size=8)
    | st.sampled_from(["border", "mm", "radial", "paper", "1/x", "triangular"]),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=8,
)
PLACES = [
    f"{table}.{field.alias or key}"
    for table, part in Design.model_fields.items()
    if hasattr(part.annotation, "model_fields")
    for key, field in part.annotation.model_fields.items()
] + [*Design.model_fields]


@pytest.mark.slow
@given(st.lists(st.tuples(st.sampled_from(PLACES), values), max_size=3))
@example([("pins", [{"where": "border", "target_mm": [1, [2]]}])])
@example([("pins", [{"corners": [0], "target_mm": []}])])
@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_garbage_is_refused_or_laid_out(changes):
    try:
        layout(Design.from_dict(changed(*changes)))
    except DesignError as error:
        assert str(error).isprintable()


def number(low, high):
    return st.floats(low, high, allow_subnormal=False)


good_fields = st.one_of(
    number(1, 6),
    st.fixed_dictionaries(
        {"profile": st.just("radial"), "from": number(1, 6), "to": number(1, 6), "over_mm": number(1, 99)}
    ),
    st.builds(lambda a: {"formula": f"3 + {a!r}*cos(theta)"}, number(-2, 2)),
    st.just({"profile": "table", "distance_mm": [0, 9], "values": [2, 3.5], "smooth": True}),
)
KNIT = {"modulus_mpa": [9.0, 4.0], "shear_modulus_mpa": 1.5, "grain_deg": 30.0, "bending_stiffness_n_mm": [0.4, 0.3]}
good_designs = st.fixed_dictionaries(
    {
        "name": st.text(st.characters(exclude_categories=["C", "Z"]), min_size=1, max_size=9),
        "fabric": st.just(KNIT) | st.fixed_dictionaries({"stretch": number(1, 3) | st.tuples(*2 * [number(1, 3)])}),
        "lattice": st.fixed_dictionaries({"arms": st.integers(3, 8), "orientation_deg": number(-360, 360)}),
        "stars": st.fixed_dictionaries(
            {"length_mm": good_fields, "override": st.just([]) | st.just([{"star": 3, "thickness_mm": 1}])}
        ),
        "border": st.just({"rings": 2}) | st.just({"polygon_mm": [[0, 0], [70, 0], [80, 90]]}),
        "pins": st.just([]) | st.just([{"corners": [0, 1], "scale": 0.8}, {"points_mm": [[20, 10]], "slide": "z"}]),
        "solver": st.fixed_dictionaries({"seed": st.integers(0, 2**32 - 1)}),
    }
)


@pytest.mark.slow
@given(good_designs, st.sampled_from(["toml", "json"]))
@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_round_trip(tmp_path, data, suffix):
    design = Design.from_dict(data)
    assert Design.from_dict(design.to_dict()) == design
    json.dumps(design.to_dict(), allow_nan=False)
    save_design(design, tmp_path / f"design.{suffix}")
    again = load_design(tmp_path / f"design.{suffix}")
    assert again == design
    one, two = layout(design), layout(again)
    assert all(repr(value) == repr(getattr(two, key)) for key, value in vars(one).items())


def _sections(model: type[BaseModel]) -> list[type[BaseModel]]:
    inner = [t for f in model.model_fields.values() for t in (f.annotation, *get_args(f.annotation))]
    return [model] + [s for t in inner if isinstance(t, type) and issubclass(t, BaseModel) for s in _sections(t)]


def test_every_key_is_documented():
    text = (Path(__file__).parents[2] / "docs" / "reference" / "design-file.md").read_text(encoding="utf-8")
    sections = [*_sections(Design), Override, *MARKED_PROFILES.values(), *NAMED_PROFILES.values()]
    assert len(sections) >= 17
    keys = {field.alias or key for model in sections for key, field in model.model_fields.items()}
    assert {key for key in keys if not re.search(rf"\b{key}\b", text)} == set()
