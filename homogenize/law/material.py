"""The material file of a law: fabric, plastic, lattice, and the plan of the unit cells."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

import numpy as np
from pydantic import Field, ValidationError, ValidationInfo, model_validator

from asterism.homogenize.cell.point_group import GRADED_OFF_LINES, aligned_lines
from asterism.homogenize.law.axes import AXES, LENGTH, named_sizes
from asterism.homogenize.law.plan import CampaignPlan, CellTask
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError, from_validation
from asterism.pattern.design.files import read_table
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.material_files import MeasurementNote
from asterism.pattern.design.materials import Fabric, Plastic
from asterism.pattern.design.section import Line, Section

PAPER_MATERIAL = Path(__file__).parents[1] / "data" / "paper.toml"


class Material(Section):
    """A material file: fabric, plastic and lattice as in a design, and the plan of the unit cells.

    Examples
    --------
    >>> paper = load_material()
    >>> paper.name, paper.stretches, len(paper.tasks())
    ('paper', (1.35, 1.75), 1402)
    """

    name: Line = Field("material", min_length=1, max_length=100)
    measured: MeasurementNote | None = None
    fabric: Fabric = Fabric()
    plastic: Plastic = Plastic()
    lattice: Lattice = Lattice()
    plan: CampaignPlan = CampaignPlan()

    @model_validator(mode="after")
    def _fits(self, info: ValidationInfo) -> Self:
        if not self.name.isprintable():
            raise DesignError("name", "must be one line of printable characters", self.name)
        if not isinstance(self.fabric.stretch, float | int):
            raise DesignError("fabric.stretch", "must be one number: unit cells have equal stretch in x and y")
        if self.plan.stretches is not None and "stretch" in self.fabric.model_fields_set:
            raise DesignError("fabric.stretch", "conflicts with plan.stretches: remove one", self.fabric.stretch)
        if self.plan.graded and self.fabric.bending_follows_mesh:
            problem = 'needs fabric.bending = "plate" or "consistent": the paper\'s hinges follow the mesh'
            raise DesignError("plan.graded", problem, True)
        if self.plan.graded and aligned_lines(self.lattice) is None:
            raise DesignError("plan.graded", f"must be false: {GRADED_OFF_LINES}", True)
        if "plan" not in self.model_fields_set and not (info.context or {}).get("plan_is_used", True):
            return self
        spacing = self.lattice.spacing_mm
        grid = self.plan.kind == "grid"
        if self.plan.ranges[0][1] > spacing * (1 + 1e-6):
            if "plan" not in self.model_fields_set:
                problem = f"needs a [plan] of its own: the plan of the paper has arms of {self.plan.ranges[0][1]:g} mm"
                raise DesignError("lattice.spacing_mm", problem, spacing)
            key = LENGTH.nodes_key if grid else LENGTH.range_key
            raise DesignError(f"plan.{key}", f"must be at most the spacing {spacing:g}", self.plan.ranges[0][1])
        if self.plan.edge_mm > spacing / 3:
            raise DesignError("plan.edge_mm", f"must be at most a third of the spacing {spacing:g}", self.plan.edge_mm)
        return self

    @property
    def stretches(self) -> tuple[float, ...]:
        """The stretches of the law, one table each."""
        return self.plan.stretches or (float(np.max(self.fabric.stretch)),)

    def tasks(self) -> list[CellTask]:
        """Every cell of the plan, sorted; the bare fabric once per stretch."""
        bare = (0.0, *(low for low, _ in self.plan.ranges[1:]))
        fitted = [bare, *self.plan.sizes()]
        tests = self.plan.test_sizes(self.lattice.spacing_mm)
        return sorted(
            {
                CellTask(stretch, held_out, sizes)
                for stretch in self.stretches
                for held_out, rows in ((False, fitted), (True, tests))
                for sizes in rows
            }
        )

    def design(self, task: CellTask) -> Design:
        """The design whose unit cell is solved. Its outline has no effect."""
        side = 3 * self.lattice.spacing_mm
        return Design.from_dict(
            {
                "name": self.name,
                "fabric": {**self.fabric.model_dump(mode="json"), "stretch": task.stretch},
                "plastic": self.plastic.model_dump(mode="json"),
                "lattice": self.to_dict()["lattice"],
                "stars": named_sizes(task.sizes),
                "border": {"rectangle_mm": [side, side]},
                "mesh": {"graded": self.plan.graded},
            }
        )

    def to_dict(self) -> dict[str, Any]:
        """Plain data with all defaults; the inverse of `from_dict`."""
        data = self.model_dump(mode="json", by_alias=True, exclude_none=True)
        scattered = [*(axis.range_key for axis in AXES), "count"]
        for key in scattered if self.plan.kind == "grid" else [axis.nodes_key for axis in AXES]:
            del data["plan"][key]
        if self.plan.stretches is not None:
            del data["fabric"]["stretch"]
        return data

    @classmethod
    def from_dict(cls, data: Mapping[str, Any], file: str | Path | None = None, plan_is_used: bool = True) -> Material:
        """A material from plain data.

        Parameters
        ----------
        plan_is_used : whether the plan must fit the lattice also if the data contain none.

        Raises
        ------
        DesignError
            A value is wrong; the message names the file and the field.
        """
        try:
            return cls.model_validate(data, context={"plan_is_used": plan_is_used})
        except ValidationError as error:
            raise from_validation(error, file) from None


def load_material(path: str | Path = PAPER_MATERIAL, plan_is_used: bool = True) -> Material:
    """A material from a TOML or JSON file; by default the paper's.

    Parameters
    ----------
    plan_is_used : whether the plan must fit the lattice also if the file has none.

    Raises
    ------
    DesignError
        The file cannot be read, or a value is wrong.
    """
    return Material.from_dict(read_table(Path(path)), path, plan_is_used)
