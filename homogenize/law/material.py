"""The material file of a law: fabric, plastic, lattice, and the plan of the unit cells."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any, Self

import numpy as np
from pydantic import Field, ValidationError, ValidationInfo, field_validator, model_validator

from asterism.homogenize.cell.point_group import GRADED_OFF_LINES, aligned_lines
from asterism.homogenize.law.plan import LawPlan, Size
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError, from_validation
from asterism.pattern.design.files import read_table
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.material_files import MeasurementNote
from asterism.pattern.design.materials import Fabric, Plastic
from asterism.pattern.design.section import Line, Number, Section, Whole
from asterism.pattern.design.spread import Spread
from asterism.pattern.design.stars import LENGTH, MIN_ARM_MM, STAR_SIZES, StarSize

# cells of one grid
MAX_SAMPLES = 100_000
# stars are at least 1 mm apart, and a cell has at least three edges between two stars
MIN_CELL_EDGE_MM = 0.2
# between two stretches: designs with rounded numbers must find the stretch of their table
MIN_STRETCH_STEP = 1e-4
AxisNodes = tuple[Number, ...]
_BY_NODES = {size.nodes_key: size for size in STAR_SIZES}
PAPER_MATERIAL = Path(__file__).parents[1] / "data" / "paper.toml"


class CampaignPlan(Section):
    """Section `[plan]` of a material file: which unit cells are solved."""

    # the law has one table for each; by default the stretch of the fabric alone.
    stretches: AxisNodes | None = Field(None, min_length=1, max_length=20)
    # lengths_mm, thicknesses_mm, widths_mm: increasing; all combinations are solved. The bare fabric (length 0) is
    # always among them.
    lengths_mm: AxisNodes = Field((2.0, 4.0, 5.5, 7.0, 8.5, 10.0, 11.5, 13.0), min_length=1, max_length=200)
    thicknesses_mm: AxisNodes = Field((0.2, 0.25, 0.3, 0.4, 0.5, 0.6), min_length=1, max_length=200)
    widths_mm: AxisNodes = Field((0.8, 1.2, 1.6), min_length=1, max_length=200)
    # of the cells' mesh. Sheets that use the law have meshes with the same edge length.
    edge_mm: Number = Field(2.0, ge=MIN_CELL_EDGE_MM, le=100)
    graded: bool = False  # finer at arms and tips, as sheets with `mesh.graded`; not for the paper's hinges
    held_out: Whole = Field(12, ge=0, le=10_000)  # number of random cells per stretch that test the law

    @field_validator("stretches", *_BY_NODES)
    @classmethod
    def _are_nodes(cls, values: AxisNodes | None, info: ValidationInfo) -> AxisNodes | None:
        axis = _BY_NODES.get(str(info.field_name))
        if values is None:
            return None
        if any(b <= a for a, b in pairwise(values)):
            raise DesignError("", "must increase", list(values))
        if axis is not LENGTH:
            low, high = axis.limits if axis else (1.0, 3.0)
            if not all(low <= v <= high for v in values):
                raise DesignError("", f"must be from {low:g} to {high:g}", list(values))
            if axis is None and any(b - a < MIN_STRETCH_STEP * (1.0 - 1e-6) for a, b in pairwise(values)):
                raise DesignError("", f"must be at least {MIN_STRETCH_STEP:g} apart", list(values))
            return values
        printed = [v for v in values if v != 0]
        if not all(v >= MIN_ARM_MM for v in printed):
            raise DesignError("", f"must be at least {MIN_ARM_MM:g}: shorter arms are not printed", list(values))
        if not printed:
            raise DesignError("", "must hold a length above 0: the bare fabric is always there", list(values))
        return values

    @model_validator(mode="after")
    def _few_cells(self) -> Self:
        if math.prod(len(self.nodes(size)) for size in STAR_SIZES) > MAX_SAMPLES:
            raise DesignError("", f"must have at most {MAX_SAMPLES} cells in its grid")
        return self

    def nodes(self, size: StarSize) -> AxisNodes:
        """Nodes of a size."""
        nodes: AxisNodes = getattr(self, size.nodes_key)
        return nodes


class Material(Section):
    """A material file: fabric, plastic, spread and lattice as in a design, and the plan of the unit cells.

    >>> paper = load_material()
    >>> paper.name, paper.plan.stretches, len(paper.law_plan().tasks())
    ('paper', (1.35, 1.75), 1226)
    """

    name: Line = Field("material", min_length=1, max_length=100)
    measured: MeasurementNote | None = None
    fabric: Fabric = Fabric()
    plastic: Plastic = Plastic()
    spread: Spread | None = None
    lattice: Lattice = Lattice()
    plan: CampaignPlan = CampaignPlan()

    @model_validator(mode="after")
    def _fits(self, info: ValidationInfo) -> Self:
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
        spacing, longest = self.lattice.spacing_mm, self.plan.lengths_mm[-1]
        if longest > spacing * (1 + 1e-6):
            if "plan" not in self.model_fields_set:
                problem = f"needs a [plan] of its own: the plan of the paper has arms of {longest:g} mm"
                raise DesignError("lattice.spacing_mm", problem, spacing)
            raise DesignError(f"plan.{LENGTH.nodes_key}", f"must be at most the spacing {spacing:g}", longest)
        if self.plan.edge_mm > spacing / 3:
            raise DesignError("plan.edge_mm", f"must be at most a third of the spacing {spacing:g}", self.plan.edge_mm)
        return self

    def law_plan(self) -> LawPlan:
        """The cells of the law. The outline of their design has no effect."""
        sizes = tuple(Size(size.key, tuple(v for v in self.plan.nodes(size) if v > 0)) for size in STAR_SIZES)
        stretches = self.plan.stretches or (float(np.max(self.fabric.stretch)),)
        side = 3 * self.lattice.spacing_mm
        design = Design.from_dict(
            {
                "name": self.name,
                "fabric": {**self.fabric.model_dump(mode="json"), "stretch": stretches[0]},
                "plastic": self.plastic.model_dump(mode="json"),
                "lattice": self.to_dict()["lattice"],
                "stars": {size.key: size.nodes[0] for size in sizes},
                "border": {"rectangle_mm": [side, side]},
                "mesh": {"graded": self.plan.graded},
            }
        )
        return LawPlan(design, sizes, stretches, self.plan.edge_mm, self.plan.held_out)

    def to_dict(self) -> dict[str, Any]:
        """Plain data with all defaults; the inverse of `from_dict`."""
        data = self.model_dump(mode="json", by_alias=True, exclude_none=True)
        if self.plan.stretches is not None:
            del data["fabric"]["stretch"]
        return data

    @classmethod
    def from_dict(cls, data: Mapping[str, Any], file: str | Path | None = None, plan_is_used: bool = True) -> Material:
        """A material from plain data.

        Raises `DesignError` if a value is wrong; the message names the file and the field.

        Parameters
        ----------
        plan_is_used : whether the plan must fit the lattice also if the data contain none.
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
