"""Formulas: parsed, checked against a short list of allowed operations, never executed as code."""

from __future__ import annotations

import ast
import operator
import warnings
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats

MAX_FORMULA_CHARACTERS = 500
MAX_FORMULA_NESTING = 40
FORMULA_VARIABLES = ("x", "y", "r", "theta")
FORMULA_CONSTANTS = {"pi": np.pi}

_BINARY: dict[type[ast.AST], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
}
_UNARY: dict[type[ast.AST], Callable[[Any], Any]] = {ast.USub: operator.neg, ast.UAdd: operator.pos}
_COMPARE: dict[type[ast.AST], Callable[[Any, Any], Any]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
# name: (function, number of arguments)
_FUNCTIONS: dict[str, tuple[Callable[..., Any], int]] = {
    "sin": (np.sin, 1),
    "cos": (np.cos, 1),
    "tan": (np.tan, 1),
    "exp": (np.exp, 1),
    "log": (np.log, 1),
    "sqrt": (np.sqrt, 1),
    "abs": (np.abs, 1),
    "floor": (np.floor, 1),
    "min": (np.minimum, 2),
    "max": (np.maximum, 2),
    "atan2": (np.arctan2, 2),
    "hypot": (np.hypot, 2),
    "clip": (lambda a, low, high: np.minimum(np.maximum(a, low), high), 3),
    "where": (lambda condition, yes, no: np.where(condition != 0, yes, no), 3),
}


class ExpressionError(ValueError):
    """A formula that cannot be evaluated; the message completes "the formula ..."."""


def checked_expression(text: str) -> str:
    """The formula itself; `ExpressionError` unless it is made of known names, numbers and operations."""
    evaluate(text, {name: np.ones(1) for name in FORMULA_VARIABLES})
    return text


def evaluate(text: str, variables: Mapping[str, Floats]) -> Floats:
    """Values of the formula, of the shape of the variables; inf or nan where it has no value.

    >>> evaluate("where(x > 0, 2, 1)", {"x": np.array([-1.0, 1.0])}).tolist()
    [1.0, 2.0]
    """
    tree = _parsed(text)
    shape = np.broadcast_shapes(*(value.shape for value in variables.values()))
    with np.errstate(all="ignore"):
        result = _value(tree, variables, 0)
    return np.broadcast_to(np.asarray(result, dtype=float), shape).copy()


def _parsed(text: str) -> ast.expr:
    if len(text) > MAX_FORMULA_CHARACTERS:
        raise ExpressionError(f"must be at most {MAX_FORMULA_CHARACTERS} characters long")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ExpressionError("is not a formula: check brackets and operators (powers are **)") from None


def _value(node: ast.expr, variables: Mapping[str, Floats], depth: int) -> Any:
    """Floating-point value of a node; powers overflow to inf."""
    if depth > MAX_FORMULA_NESTING:
        raise ExpressionError(f"must be nested at most {MAX_FORMULA_NESTING} deep")

    def inner(child: ast.expr) -> Any:
        return _value(child, variables, depth + 1)

    match node:
        case ast.Constant(value=bool()):
            pass
        case ast.Constant(value=int() | float() as number):
            try:
                return np.float64(number)
            except OverflowError:
                raise ExpressionError("has a number too large to work with") from None
        case ast.Name(id=name) if name in variables or name in FORMULA_CONSTANTS:
            return variables[name] if name in variables else np.float64(FORMULA_CONSTANTS[name])
        case ast.Name(id=name):
            known = ", ".join([*FORMULA_VARIABLES, *FORMULA_CONSTANTS])
            raise ExpressionError(f"has an unknown name {name}; known are {known}")
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
            # a sum of many terms is nested to the left, and is not deep
            return _BINARY[type(op)](_value(left, variables, depth), inner(right))
        case ast.UnaryOp(op=op, operand=operand) if type(op) in _UNARY:
            return _UNARY[type(op)](inner(operand))
        case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in _COMPARE:
            return np.float64(1) * _COMPARE[type(op)](inner(left), inner(right))
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]) if name in _FUNCTIONS:
            function, count = _FUNCTIONS[name]
            if len(arguments) != count:
                raise ExpressionError(f"has {name} with {len(arguments)} arguments, it takes {count}")
            return function(*(inner(argument) for argument in arguments))
        case ast.Call(func=ast.Name(id=name)) if name in _FUNCTIONS:
            raise ExpressionError(f"has {name} with arguments by name, it takes them in order")
        case ast.Call(func=ast.Name(id=name)):
            raise ExpressionError(f"has an unknown function {name}; known are {', '.join(_FUNCTIONS)}")
        case _:
            pass
    raise ExpressionError(
        "may only hold numbers, + - * / % **, < <= > >=, brackets and the known functions; powers are **"
    )
