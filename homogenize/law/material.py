"""The material file of a law: fabric, plastic, lattice, and the plan of the unit cells."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

import numpy as np
from pydantic import Field, ValidationError, model_validator

from homogenize.law.plan import CampaignPlan, CellTask
from pattern.design.design import Design
from pattern.design.errors import DesignError, from_validation
from pattern.design.files import read_table
from pattern.design.lattice import Lattice
from pattern.design.materials import Fabric, Plastic
from pattern.design.section import Line, Section

PAPER_MATERIAL = Path(__file__).parents[1] / "data" / "paper.toml"


class Material(Section):
    """A material file: fabric, plastic and lattice as in a design, and the plan."""

    name: Line = Field("material", min_length=1, max_length=100)
    fabric: Fabric = Fabric()
    plastic: Plastic = Plastic()
    lattice: Lattice = Lattice()
    plan: CampaignPlan = CampaignPlan()

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if not self.name.isprintable():
            raise DesignError("name", "must be one line of printable characters", self.name)
        if not isinstance(self.fabric.stretch, float | int):
            raise DesignError("fabric.stretch", "must be one number: cells are stretched alike in x and y")
        if self.plan.stretches is not None and "stretch" in self.fabric.model_fields_set:
            raise DesignError("fabric.stretch", "is given by plan.stretches, leave one out", self.fabric.stretch)
        spacing = self.lattice.spacing_mm
        grid = self.plan.kind == "grid"
        if self.plan.ranges[0][1] > spacing * (1 + 1e-6):
            key = "lengths_mm" if grid else "length_range_mm"
            raise DesignError(f"plan.{key}", f"must be at most the spacing {spacing:g}", self.plan.ranges[0][1])
        if self.plan.edge_mm > spacing / 3:
            raise DesignError("plan.edge_mm", f"must be at most a third of the spacing {spacing:g}", self.plan.edge_mm)
        return self

    @property
    def stretches(self) -> tuple[float, ...]:
        """The stretches of the law."""
        return self.plan.stretches or (float(np.max(self.fabric.stretch)),)

    def tasks(self) -> list[CellTask]:
        """Every cell of the plan, sorted; the bare fabric once per stretch."""
        (_, (thin, _), (narrow, _)) = self.plan.ranges
        own = [(0.0, thin, narrow), *self.plan.sizes()]
        tests = self.plan.tests(self.lattice.spacing_mm)
        every = ((False, own), (True, tests))
        return sorted({CellTask(s, held, *sizes) for s in self.stretches for held, rows in every for sizes in rows})

    def design(self, task: CellTask) -> Design:
        """The design whose cell is solved; its border is of no importance."""
        side = 3 * self.lattice.spacing_mm
        return Design.from_dict(
            {
                "name": self.name,
                "fabric": {**self.fabric.model_dump(mode="json"), "stretch": task.stretch},
                "plastic": self.plastic.model_dump(mode="json"),
                "lattice": self.to_dict()["lattice"],
                "stars": {
                    "length_mm": task.length_mm,
                    "thickness_mm": task.thickness_mm,
                    "width_mm": task.width_mm,
                },
                "border": {"rectangle_mm": [side, side]},
            }
        )

    def to_dict(self) -> dict[str, Any]:
        """Plain data, complete with defaults; `from_dict` makes the same material of it."""
        data = self.model_dump(mode="json", by_alias=True, exclude_none=True)
        kinds = {"lengths_mm", "thicknesses_mm", "widths_mm"}
        ranges = {"length_range_mm", "thickness_range_mm", "width_range_mm", "count"}
        for key in ranges if self.plan.kind == "grid" else kinds:
            del data["plan"][key]
        if self.plan.stretches is not None:
            del data["fabric"]["stretch"]
        return data

    @classmethod
    def from_dict(cls, data: Mapping[str, Any], file: str | Path | None = None) -> Material:
        """A material from plain data; `DesignError` names file and field."""
        try:
            return cls.model_validate(data)
        except ValidationError as error:
            raise from_validation(error, file) from None


def load_material(path: str | Path = PAPER_MATERIAL) -> Material:
    """A material from a TOML or JSON file; the paper's by default."""
    return Material.from_dict(read_table(Path(path)), path)
