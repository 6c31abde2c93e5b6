"""Sizing fields at single points; formulas: values, and nothing but values."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image, ImageOps
from pydantic import TypeAdapter

from asterism.pattern.design.design import Design, save_design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.sizing.expression import ExpressionError, checked_expression, evaluate
from asterism.pattern.design.sizing.profiles import SizingField, sample
from asterism.pattern.layout.build import load_design

POINTS = np.array([[0.0, 0.0], [5.0, 0.0], [0.0, -10.0], [30.0, 40.0]])


@pytest.mark.parametrize(
    ("field", "expected"),
    [
        (7, [7, 7, 7, 7]),
        ({"profile": "radial", "from": 10, "to": 4, "over_mm": 20}, [10, 8.5, 7, 4]),
        ({"profile": "radial", "from": 10, "to": 4, "over_mm": 20, "power": 2}, [10, 10 - 6 / 16, 8.5, 4]),
        (
            {"profile": "radial", "from": 10, "to": 4, "over_mm": 20, "centre_mm": [5, 0]},
            [8.5, 10, 10 - 6 * 125**0.5 / 20, 4],
        ),
        ({"profile": "linear", "from": 1, "to": 2, "start_mm": [0, 0], "end_mm": [0, -20]}, [1, 1, 1.5, 1]),
        ({"profile": "axis", "axis": "y", "from": 1, "to": 3, "over_mm": 20}, [1, 1, 2, 3]),
        ({"profile": "axis", "axis": "x", "from": 1, "to": 3, "over_mm": 10, "centre_mm": [5, 9]}, [2, 1, 2, 3]),
        ({"profile": "table", "distance_mm": [5, 10, 20], "values": [1, 2, 9]}, [1, 1, 2, 9]),
        ({"formula": "x + y"}, [0, 5, -10, 70]),
    ],
)
def test_values(field, expected):
    read = TypeAdapter(SizingField).validate_python(field)
    np.testing.assert_allclose(sample(read, POINTS), expected, atol=1e-12)


def test_smooth_table_keeps_its_values_and_does_not_overshoot():
    table = {"profile": "table", "distance_mm": [0, 10, 20, 30], "values": [10, 10, 4, 4], "smooth": True}
    at = np.column_stack([np.linspace(0, 40, 81), np.zeros(81)])
    values = sample(TypeAdapter(SizingField).validate_python(table), at)
    np.testing.assert_allclose(values[[0, 20, 40, 60, 80]], [10, 10, 4, 4, 4])
    assert values.max() <= 10 and values.min() >= 4 and np.all(np.diff(values) <= 1e-12)


@pytest.fixture
def picture(tmp_path):
    """Left half black, right half white, the lower half of the right column grey."""
    grey = np.zeros((20, 40), dtype=np.uint8)
    grey[:, 20:] = 255
    grey[10:, 20:] = 51
    Image.fromarray(grey).save(tmp_path / "map.png")
    return tmp_path


def _with_picture(**more):
    field = {"image": "map.png", "low": 4, "high": 9, "extent_mm": [80, 40], **more}
    return {"name": "p", "stars": {"length_mm": field}, "border": {"rings": 1}}


def test_picture_is_bilinear_and_upright(picture):
    field = Design.from_dict(_with_picture(), picture).stars.length_mm
    at = np.array([[-30, 5], [30, 10], [30, -10], [0, 10], [1000, 1000.0]])
    np.testing.assert_allclose(sample(field, at), [4, 9, 5, 6.5, 9])


def test_picture_stays_with_the_design(picture):
    design = Design.from_dict(_with_picture(), picture)
    save_design(design, picture / "design.toml")
    (picture / "map.png").unlink()
    assert load_design(picture / "design.toml") == design


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize("orientation", range(1, 9))
def test_photographs_are_read_as_they_are_shown(orientation, bits, tmp_path):
    """A picture that is stored turned says so; what every viewer shows is what counts."""
    steps = np.arange(40 * 20).reshape(20, 40) * (2**bits - 1) / 800
    stored = Image.fromarray(steps.astype(np.uint8 if bits == 8 else np.uint16))
    about = stored.getexif()
    about[0x0112] = orientation
    stored.save(tmp_path / "map.png", exif=about)
    ImageOps.exif_transpose(Image.open(tmp_path / "map.png")).save(tmp_path / "shown.png")
    at = np.random.default_rng(0).uniform(-40, 40, (20, 2))
    one, other = (
        sample(Design.from_dict(_with_picture(image=name), tmp_path).stars.length_mm, at)
        for name in ("map.png", "shown.png")
    )
    np.testing.assert_allclose(one, other)
    if orientation == 3:  # half a turn
        stored.save(tmp_path / "unturned.png")
        plain = Design.from_dict(_with_picture(image="unturned.png"), tmp_path).stars.length_mm
        np.testing.assert_allclose(sample(plain, -at), one)


@pytest.mark.parametrize(
    ("values", "problem"), [(np.float32([[0.0, 0.5]]), "in place of grey"), (np.int32([[0, 255]]), "has 32 bits")]
)
def test_pictures_of_numbers_are_refused(values, problem, tmp_path):
    Image.fromarray(values).save(tmp_path / "map.tiff")
    with pytest.raises(DesignError, match=problem):
        Design.from_dict(_with_picture(image="map.tiff"), tmp_path)


@pytest.mark.parametrize("content", [None, b"", b"not a picture", b"\x89PNG\r\n\x1a\n garbage"])
def test_picture_that_cannot_be_read(tmp_path, content):
    if content is not None:
        (tmp_path / "map.png").write_bytes(content)
    with pytest.raises(DesignError, match=r"stars\.length_mm\.image = 'map.png'"):
        Design.from_dict(_with_picture(), tmp_path)


def test_large_picture_is_scaled_down(tmp_path):
    Image.new("RGBA", (1000, 400), (0, 0, 0, 0)).save(tmp_path / "map.png")
    field = Design.from_dict(_with_picture(), tmp_path).stars.length_mm
    assert field.pixels == (256, 102)
    assert sample(field, np.zeros((1, 2))) == pytest.approx(9)  # transparent is paper


@pytest.mark.slow
@pytest.mark.filterwarnings("error::UserWarning", "error::RuntimeWarning")
@pytest.mark.parametrize("side", [9500, 14_000])
def test_pictures_of_too_many_pixels_are_said_to_be(side, tmp_path):
    Image.new("1", (side, side)).save(tmp_path / "map.png")
    with pytest.raises(DesignError, match="has too many pixels"):
        Design.from_dict(_with_picture(), tmp_path)


AT = {
    "x": np.array([3.0, -1.0]),
    "y": np.array([4.0, 2.0]),
    "r": np.array([5.0, 5**0.5]),
    "theta": np.array([0.5, 2.0]),
}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("7", [7, 7]),
        ("4 + 6*exp(-(r/30)**2)", [4 + 6 * math.exp(-25 / 900), 4 + 6 * math.exp(-5 / 900)]),
        ("-x + +y % 3", [-3 + 1, 1 + 2]),
        ("min(x, y) + max(0, x)", [6, -1]),
        ("clip(x, 0, 2)", [2, 0]),
        ("where(x < 0, 1, 2)", [2, 1]),
        ("(x > 0) * 5", [5, 0]),
        ("hypot(x, y) - r", [0, 0]),
        ("atan2(y, x)", [math.atan2(4, 3), math.atan2(2, -1)]),
        ("sqrt(abs(x)) * floor(2.7) * cos(0)", [2 * math.sqrt(3), 2]),
        ("pi * log(exp(1)) + 0*theta", [math.pi, math.pi]),
        ("  10 ", [10, 10]),
    ],
)
def test_values_of_formulas(text, expected):
    np.testing.assert_allclose(evaluate(text, AT), expected, atol=1e-12)


@pytest.mark.parametrize(
    "text",
    [
        "", "x +", "x y", "import os", "__import__('os').system('true')", "().__class__", "x.real", "x[0]", "[x]",
        "lambda: 1", "exec('1')", "open('f')", "'text'", "True", "None", "1j", "x if y else r", "x and y", "not x",
        "0 < x < 1", "x == y", "x is y", "f'{x}'", "sin(x=1)", "sin()", "sin(*x)", "min(1)", "z + 1", "x := 3", "~x",
        "x @ y", "x // y", "x << 3", "x; y", "x\ny", "x\x00", "(" * 300 + "x" + ")" * 300, "-" * 60 + "x",
        "print", "pi()", "x(1)", "{**x}", "yield x", "await x", "...", "x+" * 400 + "x",
    ],
)  # fmt: skip
def test_formulas_that_are_refused(text):
    with pytest.raises(ExpressionError, match="nested at most 40 deep" if text.startswith("--") else ""):
        checked_expression(text)


@pytest.mark.parametrize("text", ["9**9**9**9**9", "10**400", "exp(1e9)", "1/0", "log(-1)", "(-1)**0.5"])
def test_no_value_is_not_finite_and_quick(text):
    assert not np.isfinite(evaluate(text, AT)).any()


@given(st.text(max_size=80) | st.text(alphabet="xyr()+-*/%.,<>=0123456789 eminaxsctw_[]'\"", max_size=80))
@settings(max_examples=60)
def test_any_text_is_a_value_or_refused(text):
    try:
        values = evaluate(text, AT)
    except ExpressionError:
        return
    assert values.shape == (2,) and values.dtype == float


def test_long_sums_are_not_deep() -> None:
    assert evaluate("+".join(["0.1*x"] * 80), AT) == pytest.approx(8.0 * AT["x"])
