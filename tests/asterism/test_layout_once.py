"""A design is laid out once in a preview, in a simulation and in a verification; shapes carry their layout."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import asterism
import asterism.exact.simulation
import asterism.verification.run
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout

DESIGN = Design.from_dict(
    {"border": {"rings": 0}, "stars": {"length_mm": 8.0, "thickness_mm": 0.35}, "mesh": {"edge_mm": 4.0}}
)


@pytest.fixture
def layouts(monkeypatch: pytest.MonkeyPatch) -> list[Design]:
    """The designs that are laid out from now on."""
    made: list[Design] = []

    def counted(design: Design) -> Layout:
        made.append(design)
        return layout(design)

    for name, module in list(sys.modules.items()):
        if name.split(".")[0] != "tests" and getattr(module, "layout", None) is layout:
            monkeypatch.setattr(module, "layout", counted)
    return made


@pytest.mark.parametrize("compute", [asterism.preview, asterism.simulate, asterism.verify])
def test_a_design_is_laid_out_once(compute: Callable[[Design], object], layouts: list[Design]) -> None:
    compute(DESIGN)
    assert layouts == [DESIGN]


def test_a_shape_has_its_layout_and_finds_it_again_from_its_design(layouts: list[Design]) -> None:
    shape = asterism.preview(DESIGN)
    assert shape.layout is shape.plan and len(layouts) == 1
    found = replace(shape, plan=None).layout
    assert found is not None and len(layouts) == 2
    assert np.array_equal(found.centres, shape.layout.centres)
    assert replace(shape, plan=None, summary={}).layout is None
