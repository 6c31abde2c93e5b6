"""Properties of all designs: garbage is refused politely, good designs survive a round trip."""

import copy
import json

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from asterism.pattern.design.design import Design, save_design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout, load_design

GOOD = {"stars": {"length_mm": 10.0}, "border": {"rings": 1}}

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
    design = copy.deepcopy(GOOD)
    for place, value in changes:
        *table, key = place.split(".")
        target = design.setdefault(table[0], {}) if table else design
        if isinstance(target, dict):
            target[key] = value
    try:
        layout(Design.from_dict(design))
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
good_designs = st.fixed_dictionaries(
    {
        "name": st.text(st.characters(exclude_categories=["C", "Z"]), min_size=1, max_size=9),
        "fabric": st.fixed_dictionaries({"stretch": number(1, 3) | st.tuples(number(1, 3), number(1, 3))}),
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
