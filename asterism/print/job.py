"""The print job: a design prepared for a printer, from which all files of an export are written, and its cost."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.rounding import Rounding
from asterism.pattern.geometry.planar import off_sheet_mm
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.print.bed_placement import BedPlacement, place_on_bed, room_mm
from asterism.print.needles import Needle, needles, needles_in_plastic
from asterism.print.printer import PlasticProfile, Printer
from asterism.print.rounding import choose_rounding, rounded_layout, size_changes, with_rounding
from asterism.print.solid import (
    Piece,
    Solid,
    Terrace,
    border_terrace,
    cutting_lines,
    pieces,
    plastic_terraces,
    terraced_solid,
)
from asterism.process.settings import ExportSettings
from asterism.results.records.export import PrintCostRecord, SizeChangeRecord
from asterism.shape.shape import Shape


@dataclass(frozen=True)
class Job:
    """A design prepared for a printer."""

    drawn: Design
    design: Design  # the drawn one with the printer's rounding
    printer: Printer
    plastic: PlasticProfile
    settings: ExportSettings  # thickness and set of the fabric, distance of the needles
    rounding: Rounding
    drawn_plan: Layout  # of the drawn design, in printed coordinates
    plan: Layout  # of the rounded design, in printed coordinates
    printed: tuple[Terrace, ...]  # terraces of stars and drawn rods, in printed coordinates
    placement: BedPlacement  # motion from printed coordinates to those of the sheets
    # the line to cut along, in sheet coordinates; None if it is switched off or does not fit
    border: Terrace | None = None
    shape: Shape | None = None  # the sheet in space whose files are written; None without these files
    too_large: str = ""  # why the print does not fit; empty if it fits
    glance: Shape | None = None  # the sheet in space from the preview, without files; for heights and warnings only

    @cached_property
    def arms(self) -> list[Piece]:
        """Pieces of all arms, in printed coordinates."""
        return pieces(self.plan, self.rounding)[0]

    @cached_property
    def rods(self) -> list[Piece]:
        """Pieces of all drawn rods, in printed coordinates."""
        return pieces(self.plan, self.rounding)[1]

    @cached_property
    def pattern(self) -> tuple[Terrace, ...]:
        """Terraces of stars and drawn rods in sheet coordinates, seen from above."""
        return tuple(map(self.placement.step, self.printed))

    @cached_property
    def above(self) -> tuple[Terrace, ...]:
        """The part of the pattern above the fabric; empty if there is none."""
        return self._on_face(1)

    @cached_property
    def below(self) -> tuple[Terrace, ...]:
        """The part of the pattern below the fabric; empty if there is none."""
        return self._on_face(-1)

    def _on_face(self, side: int) -> tuple[Terrace, ...]:
        if {piece.side for piece in (*self.arms, *self.rods)} == {side}:
            return self.pattern
        arms, rods = ([piece for piece in some if piece.side == side] for some in (self.arms, self.rods))
        return tuple(map(self.placement.step, plastic_terraces(arms, rods)))

    @cached_property
    def cut(self) -> tuple[Floats, ...]:
        """Closed lines (n, 2) to cut along, in printed coordinates: the outline first."""
        return cutting_lines(self.plan, self.rods)

    @cached_property
    def needles(self) -> tuple[Needle, ...]:
        """Needles, in printed coordinates."""
        return needles(self.plan, self.settings.needle_spacing_mm, self.shape)

    @property
    def fabric_given(self) -> bool:
        """Whether the thickness of the stretched fabric is given."""
        return self.settings.fabric_mm is not None

    @property
    def fabric_mm(self) -> float:
        """Thickness of the fabric under the nozzle: of the stretched fabric if given, else of the released fabric."""
        return self.settings.fabric_mm or self.design.fabric.thickness_mm

    @property
    def z_offset_mm(self) -> float:
        """Height of the fabric's surface above the bed."""
        return self.printer.frame.plate_mm + self.fabric_mm

    @property
    def start_code(self) -> str:
        """The printer's start code for this height, with a remark if the stretched fabric was not measured."""
        return self.printer.start_snippet(self.z_offset_mm, None if self.fabric_given else self.fabric_mm)

    @property
    def check_before_mm(self) -> float:
        """Side of the check square on the released fabric; after stretching it lies well within the frame."""
        room = np.asarray(self.printer.frame.opening_mm) / self.clamped_stretch
        # largest part of the frame's opening for the stretched check square
        most = 0.8 * float(room.min()) + 1e-9
        sides = (100.0, 80.0, 60.0, 50.0, 40.0, 30.0, 20.0, 10.0, 5.0, 2.0)
        return next((side for side in sides if side <= most), 1.0)

    @property
    def check_after_mm(self) -> tuple[float, float]:
        """Sides of the check square on the stretched fabric."""
        x, y = self.clamped_stretch
        return self.check_before_mm * x, self.check_before_mm * y

    @property
    def clamped_stretch(self) -> tuple[float, float]:
        """Stretched length over the length before, along x and y; that of the design is over the length after."""
        x, y = ((1.0 + 0.01 * self.settings.fabric_set_percent) * each for each in self.design.fabric.stretch_xy)
        return x, y

    @cached_property
    def size_changes(self) -> dict[str, SizeChangeRecord]:
        """Changes of the sizes of the arms and rods by rounding: `thickness` and `width`."""
        return size_changes(self.drawn_plan, self.plan)

    @property
    def is_rounded(self) -> bool:
        """Whether rounding changes the size of any star or rod."""
        return any(size.stars_changed or size.rods_changed for size in self.size_changes.values())

    @property
    def printed_word(self) -> str:
        """What is printed: `stars`, `rods`, or `stars and rods`."""
        return " and ".join([*(["stars"] if self.arms else []), *(["rods"] if self.rods else [])])

    @property
    def pattern_file(self) -> str:
        """Stem of the files of the pattern: `stars` or, if there are drawn rods only, `rods`."""
        return "stars" if self.arms else "rods"

    @cached_property
    def needles_in_plastic(self) -> list[int]:
        """Numbers of the needles that meet an arm or a drawn rod."""
        return needles_in_plastic(self.plan, self.needles)

    @property
    def seen(self) -> Shape | None:
        """The sheet in space; None if it is not known."""
        return self.shape or self.glance

    @property
    def is_certain(self) -> bool | None:
        """Whether the shape whose files are written is a certified minimum; None without a shape or a certificate."""
        if self.shape is None or "is_minimum" not in self.shape.summary:
            return None
        return bool(self.shape.summary["is_minimum"] and self.shape.summary.get("converged", True))

    @property
    def shape_warnings(self) -> list[str]:
        """Warnings of the shape whose files are written, one line each."""
        lines = None if self.shape is None else self.shape.summary.get("warnings")
        # the summary may come from another program
        return [" ".join(str(line).split()) for line in lines] if isinstance(lines, list | tuple) else []

    @cached_property
    def hangs_mm(self) -> float | None:
        """How far the sheet hangs below the base of its needles (mm); None if the shape is not known."""
        known = [(needle, height) for needle in self.needles if (height := needle.height_mm) is not None]
        if not known:
            return 0.0
        if self.seen is None:
            return None
        needle, height = known[0]
        base = float(self.seen.at_edges(needle.printed)[0, 2] - height)
        return max(base - float(self.seen.positions[:, 2].min()), 0.0)

    @property
    def hangs_doubt_mm(self) -> float | None:
        """Estimated error of the height of the sheet (mm); None if the shape is not a preview."""
        percent = None if self.seen is None else self.seen.summary.get("expected_height_percent")
        return None if self.seen is None or percent is None else percent / 100.0 * self.seen.summary["height_mm"]

    @cached_property
    def prints(self) -> dict[str, tuple[Solid, ...]]:
        """Stars and drawn rods in the printer's coordinates, on z = 0, by the file of their print.

        Plastic below the fabric is printed with the frame turned over, so it is mirrored: `print-below`, or `print` if
        there is none above. `print` has the border line.
        """
        bed = BedPlacement(0.0, np.asarray(self.printer.bed_centre_mm))
        line = [] if self.border is None else [("border", (self.border,))]
        prints: dict[str, tuple[Solid, ...]] = {}
        for end, steps, mirror in (("", self.above, 1.0), ("-below", self.below, -1.0)):
            if steps:
                parts = [(self.pattern_file + end, steps), *([] if prints else line)]
                prints["print-below" if prints else "print"] = tuple(
                    terraced_solid(part, [bed.step(step.stretched((mirror, 1.0))) for step in terraces])
                    for part, terraces in parts
                )
        return prints

    @property
    def solids(self) -> tuple[Solid, ...]:
        """The solids of all prints."""
        return tuple(solid for solids in self.prints.values() for solid in solids)

    @cached_property
    def cost(self) -> PrintCostRecord:
        """Plastic and time for the pattern and the border line, see `print_cost`."""
        prints = [*filter(None, (self.above, self.below)), *([(self.border,)] if self.border is not None else [])]
        return print_cost(prints, self.printer, self.rounding, self.plastic)


def prepare(
    design: Design,
    printer: Printer,
    plastic: PlasticProfile,
    settings: ExportSettings | None = None,
    shape: Shape | None = None,
    any_size: bool = False,
) -> Job:
    """Round a design for a printer and place it on the bed.

    `settings`: fabric, border, turn and needles; `shape`: the sheet in space; `any_size`: accept a print that does not
    fit, with the reason in `too_large`.

    Raises DesignError: the print does not fit the bed or the frame, its rounded arms overlap, or a value is out of
    range.
    """
    settings = ExportSettings() if settings is None else settings
    fabric_mm, turn_deg = settings.fabric_mm, settings.turn_deg
    released_mm = design.fabric.thickness_mm
    if fabric_mm is not None and fabric_mm > released_mm:
        problem = f"must be at most {released_mm:g} mm, the thickness of the released fabric: stretching thins it"
        raise DesignError("--fabric", problem, fabric_mm)
    drawn_plan = layout(design)
    rounding = choose_rounding(drawn_plan, printer)
    rounded = with_rounding(design, rounding)
    plan = rounded_layout(rounded, printer)
    x, y = design.fabric.stretch_xy
    if x != y and turn_deg % 360:
        raise DesignError("--turn", "must be 0 on a fabric that is stretched differently along x and y", turn_deg)
    printed, placement, too_large = plastic_terraces(*pieces(plan, rounding)), BedPlacement(turn_deg, np.zeros(2)), ""
    try:
        placement = place_on_bed(plan, printed, printer, turn_deg, may_turn=x == y)
    except DesignError as error:
        if not any_size:
            raise
        too_large = str(error)
    line = placement.step(border_terrace(plan, printed, rounding)) if settings.border else None
    if line is not None and not _has_room(line, printer):
        line = None
    job = Job(
        drawn=design,
        design=rounded,
        printer=printer,
        plastic=plastic,
        settings=settings,
        rounding=rounding,
        drawn_plan=drawn_plan,
        plan=plan,
        printed=printed,
        placement=placement,
        border=line,
        too_large=too_large,
    )
    return job if shape is None else with_shape(job, shape)


def with_shape(job: Job, shape: Shape) -> Job:
    """The job with the sheet in space, and its needles there; DesignError for a shape of another design."""
    _check_same_sheet(job.drawn, job.plan, shape)
    return replace(job, shape=shape)


def _has_room(step: Terrace, printer: Printer) -> bool:
    if step.region.is_empty:
        return False
    low, high = np.reshape(shapely.bounds(step.region), (2, 2))
    half = room_mm(printer) / 2
    return bool((high <= half).all() and (low >= -half).all())


def _check_same_sheet(design: Design, plan: Layout, shape: Shape) -> None:
    """Refuse a shape of another design: another outline, other stars, or other values in its summary."""
    box, other = (np.array([points.min(axis=0), points.max(axis=0)]) for points in (plan.outline, shape.printed))
    # the mesh has chords of a curved outline
    if np.abs(box - other).max() > (off_sheet_mm(plan.area_mm2, len(shape.printed)) if plan.rim else 1e-3):
        sides = [" x ".join(f"{side:.1f}" for side in sizes) for sizes in (np.ptp(box, axis=0), np.ptp(other, axis=0))]
        raise DesignError("shape", f"must be of this design, printed on {sides[0]} mm", f"a sheet of {sides[1]} mm")
    if len(shape.star_vertices) != len(plan.centres):
        stars = f"{len(shape.star_vertices)} stars"
        raise DesignError("shape", f"must be of this design with its {len(plan.centres)} stars", stars)
    if "design" in shape.summary:
        try:
            made_from = with_rounding(Design.from_dict(shape.summary["design"]), None)
        except DesignError as error:  # it would be taken for a mistake of the design at hand
            raise DesignError("shape", f"must be of this design, but its own has a mistake: {error}") from None
        for section in ("lattice", "stars", "rods", "border", "pins", "gravity"):
            if getattr(made_from, section) != getattr(with_rounding(design, None), section):
                raise DesignError("shape", f"must be of this design, but its {section} are others")
        if made_from.fabric.stretch_xy != design.fabric.stretch_xy:
            raise DesignError("shape", "must be of this design, but its fabric was stretched otherwise")
        if (made_from.fabric, made_from.plastic) != (design.fabric, design.plastic):
            raise DesignError("shape", "must be of this design, but its material is another")


def print_cost(
    prints: Sequence[Sequence[Terrace]], printer: Printer, rounding: Rounding, plastic: PlasticProfile
) -> PrintCostRecord:
    """Volume, mass, filament and time of a print, from the nested terraces of each solid.

    Lines as wide as the nozzle fill each layer at the printer's speed. The nozzle travels from each island of a layer
    to the nearest one, and loses `speed.island_s` at each. Acceleration is not modelled.
    """
    volume = float(
        sum(
            step.region.area * (step.height_mm - below)
            for steps in prints
            for step, below in zip(steps, [0.0, *(step.height_mm for step in steps)], strict=False)
        )
    )
    seconds = 60.0 * printer.speed.heating_min
    top = max(step.height_mm for steps in prints for step in steps)
    layers = 1 + max(round((top - rounding.first_layer_mm) / rounding.layer_mm), 0)
    length = 0.0
    for layer in range(layers):
        middle = rounding.first_layer_mm + (layer - 0.5) * rounding.layer_mm if layer else 0.5 * rounding.first_layer_mm
        area, islands, travel = _slice(prints, middle)
        lines = area / rounding.line_mm
        speed = printer.speed.print_mm_s if layer else printer.speed.first_layer_mm_s
        seconds += lines / speed + travel / printer.speed.travel_mm_s + islands * printer.speed.island_s
        length += lines
    return PrintCostRecord(
        volume_mm3=volume,
        mass_g=volume * plastic.density_kg_m3 * 1e-6,
        filament_m=volume / (math.pi / 4 * printer.filament_mm**2) * 1e-3,
        layers=layers,
        lines_m=length * 1e-3,
        minutes=seconds / 60.0,
    )


def _slice(prints: Sequence[Sequence[Terrace]], height_mm: float) -> tuple[float, int, float]:
    """Area (mm^2), number of islands, and travel between them (mm) of the slice at a height."""
    area, islands, travel = 0.0, 0, 0.0
    for steps in prints:
        # terraces are nested: the first one above this height is the slice
        here = next((step.region for step in steps if step.height_mm > height_mm), None)
        if here is None:
            continue
        parts = shapely.get_parts(here)
        centres = shapely.get_coordinates(shapely.centroid(parts))
        area += here.area
        islands += len(parts)
        if len(parts) > 1:
            nearest = shapely.STRtree(parts).query_nearest(
                parts, exclusive=True, all_matches=False, return_distance=False
            )
            travel += float(np.linalg.norm(centres[nearest[0]] - centres[nearest[1]], axis=1).sum())
    return area, islands, travel
