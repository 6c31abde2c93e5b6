"""Formulas: values, and nothing but values."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.pattern.design.sizing.expression import ExpressionError, checked_expression, evaluate

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
def test_values(text, expected):
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
def test_refused(text):
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
