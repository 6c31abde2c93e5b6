"""Sizes given by a formula of the place."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import field_validator

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.section import Text
from asterism.pattern.design.sizing.expression import ExpressionError, check_expression, evaluate
from asterism.pattern.design.sizing.profile import Profile


class FormulaProfile(Profile):
    """A formula in x, y (mm), r (mm from the origin) and theta (rad from the x axis).

    Examples
    --------
    >>> FormulaProfile(formula="5 + r/10").at(np.array([[3.0, 4.0]])).tolist()
    [5.5]
    """

    key: ClassVar[str] = "formula"
    is_marked_by_key: ClassVar[bool] = True
    formula: Text

    @field_validator("formula")
    @classmethod
    def _is_readable(cls, text: str) -> str:
        try:
            check_expression(text)
        except ExpressionError as problem:
            raise DesignError("", str(problem), text) from None
        return text

    def at(self, points: Floats) -> Floats:
        """(n,) values at the printed points (n, 2) mm; not finite where the formula has no value."""
        x, y = points.T
        return evaluate(self.formula, {"x": x, "y": y, "r": np.hypot(x, y), "theta": np.arctan2(y, x)})
