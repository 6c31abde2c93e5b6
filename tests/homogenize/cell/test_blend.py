"""Responses between two meshes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.homogenize.cell.sample import blend_responses


def responses(**changes: Any) -> list[dict[str, Any]]:
    """Of two meshes; changes are of the second."""
    one = {"lam": 0.8, "bending": np.array([1.0, 2.0]), "eigenvalue": 3.0}
    one |= {"offset": 0.5, "iterations": 7}
    two = {"lam": 0.9, "bending": np.array([2.0, 4.0]), "eigenvalue": 2.0}
    return [one, two | {"offset": 1.5, "iterations": 5} | changes]


def test_quantities_are_weighted_and_eigenvalues_are_the_smaller_ones() -> None:
    for each in (responses(), responses()[::-1]):
        first = 0.25 if each[0]["lam"] == 0.8 else 0.75
        found = blend_responses(each, np.array([first, 1.0 - first]))
        assert found["lam"] == pytest.approx(0.875)
        assert found["bending"] == pytest.approx([1.75, 3.5])
        assert found["eigenvalue"] == 2.0
        assert found["iterations"] == 12


def test_what_one_mesh_has_no_answer_to_has_none() -> None:
    assert blend_responses(responses(offset=None), np.array([0.5, 0.5]))["offset"] is None
    assert blend_responses(responses(failed="no root"), np.array([0.5, 0.5])) == {"failed": "no root", "iterations": 12}
