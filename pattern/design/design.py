"""The design: all choices of a user about one sheet, as sections of one file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, Self, get_args

import numpy as np
from pydantic import Field, ValidationError, ValidationInfo, field_validator, model_validator

from asterism.pattern.design.border import Border
from asterism.pattern.design.drawings import with_drawings
from asterism.pattern.design.errors import NEEDS_STARS_ALONE, DesignError, check_type, from_validation
from asterism.pattern.design.files import write_table
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.material_files import MaterialChoice, with_material_file
from asterism.pattern.design.materials import Fabric, Plastic
from asterism.pattern.design.pins import Pins
from asterism.pattern.design.rods import Rods
from asterism.pattern.design.section import Flag, Line, Number, Place, Section, Whole
from asterism.pattern.design.spread import Spread
from asterism.pattern.design.stars import Site, Stars

# on the ground
GRAVITY_M_S2 = 9.81
# keys that another table has too, but that stand for something else where they are misplaced
MEANT_KEYS = {
    ("plastic", "modulus_mpa"): "unknown key here, use modulus_ratio: the plastic's modulus over the fabric's"
}
# least and largest weight of a place; places without one have the weight 1
WEIGHT_RANGE = (0.01, 100.0)


class WeightedSite(Section):
    """The weight of the places around one star."""

    site: Site  # lattice site, as in `Override`. A site off the sheet is ignored.
    # the square of the distance to the target counts so many times.
    weight: Number = Field(ge=WEIGHT_RANGE[0], le=WEIGHT_RANGE[1])


class FitWeights(Section):
    """Weights of places in a fit."""

    # each for the cell of one lattice site; elsewhere the weight is 1.
    weights: tuple[WeightedSite, ...] = Field((), max_length=20_000)

    @model_validator(mode="after")
    def _one_weight_a_site(self) -> Self:
        sites = [entry.site for entry in self.weights]
        if len(set(sites)) < len(sites):
            twice = next(site for number, site in enumerate(sites) if site in sites[:number])
            raise DesignError("weights", "must have one entry a site", list(twice))
        return self


class Gravity(Section):
    """Weight of fabric and plastic. It needs `fabric.modulus_mpa`, not only the ratio of the moduli."""

    on: Flag = False
    direction: Place = (0.0, 0.0, -1.0)
    acceleration_m_s2: Number = Field(GRAVITY_M_S2, ge=0, le=100)

    @field_validator("direction")
    @classmethod
    def _points_somewhere(cls, direction: Place) -> Place:
        if not 1e-6 <= np.linalg.norm(direction) <= 1e6:
            raise DesignError("", "must point somewhere, e.g. [0, 0, -1]", direction)
        return direction

    @property
    def pull(self) -> Place | None:
        """The direction if the sheet has weight, else None."""
        return self.direction if self.on else None


class MeshChoice(Section):
    """The mesh of the exact model."""

    # meshes are refined until the estimated error of the shape is within this part of the diameter.
    tolerance_percent: Number = Field(1.0, ge=0.02, le=20)
    # length of the edges, of one mesh in place of a tolerance. The paper's hinges, whose stiffness follows the mesh,
    # and a fabric without bending always have one: 2 mm by default.
    edge_mm: Number | None = Field(None, ge=0.2, le=500)
    # aligned with the lattice, Delaunay, or aligned where possible (`auto`).
    kind: Literal["auto", "aligned", "delaunay"] = "auto"
    seed: Whole = Field(0, ge=0, lt=2**32)  # of the Delaunay mesh
    graded: Flag | None = None  # finer at the arms and their tips; by default the aligned meshes of a plate are


class Solver(Section):
    """The search for the shape."""

    start: Literal["bump", "flat"] = "bump"  # initial guess: all stars bumped towards the plastic, or flat with noise
    seed: Whole = Field(0, ge=0, lt=2**32)  # of the noise
    contact: Flag = False  # prevents the sheet from passing through itself


class Design(Section):
    """A sheet of plastic stars or drawn rods on stretched fabric; lengths in mm on the stretched fabric, moduli in MPa.

    Examples
    --------
    >>> design = Design.from_dict({"stars": {"length_mm": 10}, "border": {"rings": 2}})
    >>> design.lattice.arms, design.fabric.stretch
    (3, 1.35)
    """

    name: Line = Field("design", min_length=1, max_length=100)
    units: Literal["mm"] = "mm"
    material: MaterialChoice | None = None
    fabric: Fabric = Fabric()
    plastic: Plastic = Plastic()
    lattice: Lattice = Lattice()
    stars: Stars | None = None
    rods: Rods | None = None
    border: Border
    pins: tuple[Pins, ...] = Field((), max_length=1000)
    gravity: Gravity = Gravity()
    mesh: MeshChoice = MeshChoice()
    solver: Solver = Solver()
    fit: FitWeights | None = None
    spread: Spread | None = None

    @field_validator("units", mode="before")
    @classmethod
    def _millimetres(cls, units: Any) -> Any:
        if units != "mm":
            raise DesignError("", 'must be "mm": write all lengths in millimetres', units)
        return units

    @model_validator(mode="before")
    @classmethod
    def _keys_in_their_tables(cls, data: Any, info: ValidationInfo) -> Any:
        """Refuse a key in a wrong table, and name the right one: in TOML, a key belongs to the header above it.

        Then read the drawings that the tables name.
        """
        if not isinstance(data, Mapping):
            return data
        kinds = {"": cls} | {name: field.annotation for name, field in cls.model_fields.items()}
        kinds = {name: next((part for part in get_args(kind) if part), kind) for name, kind in kinds.items()}
        tables = {name: kind for name, kind in kinds.items() if isinstance(kind, type) and issubclass(kind, Section)}
        for name in tables:
            entries = data.get(name) if name else data
            if not isinstance(entries, Mapping):
                continue
            for key in entries:
                if (name, key) in MEANT_KEYS:
                    raise DesignError(f"{name}.{key}", MEANT_KEYS[name, key], entries[key])
                homes = [home for home, other in tables.items() if key in other.model_fields]
                if homes and name not in homes:
                    field = f"{name}.{key}" if name else key
                    raise DesignError(field, f"unknown key here, it belongs {_place(homes)}", entries[key])
        return with_drawings(data, (info.context or {}).get("folder", Path()))

    @model_validator(mode="after")
    def _sections_go_together(self) -> Self:
        if self.stars is None and self.rods is None:
            raise DesignError("", "must have [stars] or [rods]")
        if self.rods is None and self.border.rods is not None:
            raise DesignError("border.rods", "goes with [rods]", self.border.rods)
        if self.gravity.on and not self.fabric.has_scale:
            message = "must be given with gravity on: the default, and strips, only give a ratio"
            raise DesignError("fabric.modulus_mpa", message)
        if self.mesh.graded and self.fabric.bending_follows_mesh:
            kinds = 'needs fabric.bending = "plate", "consistent" or "none"'
            message = f"{kinds}: the stiffness of the paper's hinges follows the mesh"
            raise DesignError("mesh.graded", message, self.mesh.graded)
        return self

    @property
    def required_stars(self) -> Stars:
        """The section `[stars]`, for what is computed of stars alone.

        Raises
        ------
        DesignError
            The pattern is drawn.
        """
        if self.stars is None:
            raise DesignError("rods", NEEDS_STARS_ALONE)
        return self.stars

    @property
    def required_rods(self) -> Rods:
        """The section `[rods]`, for what is computed of drawn rods alone.

        Raises
        ------
        DesignError
            The pattern has no drawn rods.
        """
        if self.rods is None:
            raise DesignError("rods", "must be there: this needs drawn rods")
        return self.rods

    @property
    def mesh_edge_mm(self) -> float | None:
        """Length of the mesh's edges; None if the tolerance decides.

        >>> stars = {"stars": {"length_mm": 10}, "border": {"rings": 1}}
        >>> hinges = Design.from_dict(stars | {"fabric": {"bending": "paper"}})
        >>> plate = Design.from_dict(stars | {"fabric": {"bending": "consistent"}})
        >>> hinges.mesh_edge_mm, plate.mesh_edge_mm, round(plate.usual_edge_mm, 3)
        (2.0, None, 1.925)
        """
        if self.mesh.edge_mm is None and not self.fabric.bends_as_plate:
            return 2.0  # edges of the paper's meshes
        return self.mesh.edge_mm

    @property
    def usual_edge_mm(self) -> float:
        """Length of the mesh's edges, for what needs one mesh also where the tolerance decides."""
        return self.mesh_edge_mm or self.lattice.spacing_mm / 9

    @property
    def graded_meshes(self) -> bool | Literal["aligned"]:
        """Whether meshes are finer at the arms and their tips; by default those of a plate, where they are aligned."""
        if self.mesh.graded is not None:
            return self.mesh.graded
        return "aligned" if self.fabric.bends_as_plate else False

    @property
    def law_file(self) -> str | None:
        """The file of the law that the section `[material]` names."""
        return None if self.material is None else self.material.law

    @classmethod
    def from_dict(cls, data: Mapping[str, Any], folder: str | Path = ".", file: str | Path | None = None) -> Design:
        """A design from plain data; pictures and materials are looked for in `folder`. `layout` checks its geometry."""
        try:
            data = with_material_file(data, Path(folder)) if isinstance(data, Mapping) else data
            return cls.model_validate(data, context={"folder": Path(folder)})
        except DesignError as error:
            raise (error if error.file or not file else error.within(file)) from None
        except ValidationError as error:
            raise from_validation(error, file) from None

    def to_dict(self) -> dict[str, Any]:
        """Plain data, complete with defaults, fit for JSON and TOML; `from_dict` makes the same design of it."""
        return self.model_dump(mode="json", by_alias=True, exclude_none=True)


def _place(tables: list[str]) -> str:
    return " or ".join(f"in [{table}]" if table else "at the top, before all tables" for table in tables)


def save_design(design: Design, path: str | Path) -> None:
    """Write a design to a TOML or JSON file, complete with defaults.

    Raises
    ------
    DesignError
        The file's name ends in something else.
    OSError
        It cannot be written.
    """
    check_type(design, Design, "load_design reads one from a file, new one from the gallery")
    write_table(design.to_dict(), Path(path))


def leading_field(message: str) -> str:
    """The field that a message names before all else; empty if it names none.

    >>> leading_field("rods.motif[0].width_mm = 9: must be at most 5")
    'rods.motif[0].width_mm'
    >>> leading_field("the motif has no law of one cell: 2 x 2 cells relax to 90 % of its energy")
    ''
    """
    found = re.match(r"(\w+)(?:\.\w+|\[\d+\])*(?= = |: )", message)
    return found[0] if found and found[1] in Design.model_fields else ""
