"""The section `[rods]`: a pattern that is drawn by numbers, line by line, or as a motif on the lattice."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from asterism.pattern.design.border import MAX_RADIUS_MM, MIN_RADIUS_MM, DrawnCircle
from asterism.pattern.design.errors import DesignError, one_line
from asterism.pattern.design.materials import CurvaturePerMm
from asterism.pattern.design.rounding import Rounding
from asterism.pattern.design.section import FACES, Flag, Line, Number, Point, Section, Side, Text
from asterism.pattern.design.sizing.profiles import SizingField


class DrawnArc(Section):
    """A part of a circle, from one direction seen from the centre to another; counterclockwise if that is larger."""

    centre: Point = (0.0, 0.0)
    radius: Number = Field(ge=MIN_RADIUS_MM, le=MAX_RADIUS_MM)
    from_deg: Number = Field(ge=-720, le=720)
    to_deg: Number = Field(ge=-720, le=720)

    @model_validator(mode="after")
    def _is_an_arc(self) -> Self:
        if not 1.0 <= abs(self.to_deg - self.from_deg) < 360.0:
            raise DesignError(
                "to_deg", "must differ from from_deg by 1 to 360; circle_mm is a whole circle", self.to_deg
            )
        return self


class DrawnLine(Section):
    """One line of a drawing: one of `line_mm`, `spline_mm`, `circle_mm` and `arc_mm`.

    >>> DrawnLine(circle_mm={"radius": 40.0}).outline_shape
    'circle_mm'
    """

    name: Line = Field("", max_length=100)  # for messages and for `border.rods`
    line_mm: tuple[Point, ...] | None = Field(None, min_length=2, max_length=100_000)  # points that straight lines join
    # points that a smooth curve passes through.
    spline_mm: tuple[Point, ...] | None = Field(None, min_length=3, max_length=10_000)
    # circle_mm, arc_mm: a circle or an ellipse, or a part of a circle.
    circle_mm: DrawnCircle | None = None
    arc_mm: DrawnArc | None = None
    closed: Flag = False  # the line or spline returns to its first point
    # thickness_mm, width_mm: in place of those of `[rods]`.
    thickness_mm: SizingField | None = None
    width_mm: SizingField | None = None
    # residual curvature of this line's plastic, in place of that of `[plastic]`.
    kappa_bar_per_mm: CurvaturePerMm | None = None
    side: Side | None = None  # the face of the fabric that carries it, in place of that of `[rods]`

    @property
    def outline_shape(self) -> str:
        """Which of the keys has the line."""
        return next(key for key in ("line_mm", "spline_mm", "circle_mm", "arc_mm") if getattr(self, key) is not None)

    @model_validator(mode="after")
    def _one_line(self) -> Self:
        self._check_one_of("line_mm", "spline_mm", "circle_mm", "arc_mm")
        if self.closed and self.outline_shape in ("circle_mm", "arc_mm"):
            raise DesignError("closed", "goes with line_mm or spline_mm; a circle is closed, and an arc is not", True)
        return self


class LayerSizes(Section):
    """Sections and face of the lines of one layer, in place of those of the file and of `[rods]`."""

    thickness_mm: SizingField | None = None
    width_mm: SizingField | None = None
    side: Side | None = None


class StoredLine(Section):
    """A line as it was read from a file: places in mm, its layer, and the width of its stroke."""

    points_mm: tuple[Point, ...] = Field(min_length=2, max_length=100_000, repr=False)
    layer: Text
    width_mm: Number | None = None


class ImportedDrawing(Section):
    """Lines of an SVG, DXF or 3DM file.

    The file is read once. Its lines are stored in the design (`lines`), so that saved designs and results need no file.
    """

    file: Text  # path relative to the design file
    width: Literal["stroke"] | None = None  # `stroke` takes the widths of the file
    layers: dict[str, LayerSizes] | None = None  # sections by layer. If it is given, other layers are left out.
    # `middle` moves the middle of the drawing's box to the origin; `drawing` keeps its own origin.
    origin: Literal["middle", "drawing"] = "middle"
    units: Literal["mm", "cm", "in", "px", "pt"] | None = None  # unit of a file that gives none
    lines: tuple[StoredLine, ...] = Field((), repr=False)  # the lines that were read

    @model_validator(mode="after")
    def _has_its_layers(self) -> Self:
        known = sorted({line.layer for line in self.lines})
        for layer in self.layers or ():
            if layer not in known:
                raise DesignError(f"layers.{layer}", f"no such layer; the drawing has {', '.join(known)}")
        return self

    def drawn(self) -> tuple[DrawnLine, ...]:
        """The lines as lines of a drawing, named after their layers."""
        out = []
        for line in self.lines:
            if self.layers is not None and line.layer not in self.layers:
                continue
            sizes = {} if self.layers is None else dict(self.layers[line.layer])
            if self.width == "stroke" and sizes.get("width_mm") is None:
                sizes["width_mm"] = line.width_mm
            out.append(DrawnLine(name=one_line(line.layer)[:100], line_mm=line.points_mm, **sizes))
        return tuple(out)


class Rods(Section):
    """A drawn pattern. Lines that cross or meet are bonded there."""

    # thickness_mm, width_mm: cross-section of all lines that have none of their own, by place.
    thickness_mm: SizingField = 0.3
    width_mm: SizingField = 1.2
    draw: tuple[DrawnLine, ...] = Field((), max_length=20_000)  # lines on the sheet
    # (in the file: `import`) drawings of other programs.
    imported: tuple[ImportedDrawing, ...] = Field((), max_length=100, alias="import")
    # lines relative to a site of `[lattice]`, which are repeated at all sites whose copies reach the sheet.
    motif: tuple[DrawnLine, ...] = Field((), max_length=100)
    # largest distance of a curve from the straight pieces that stand for it.
    curve_mm: Number = Field(0.005, ge=0.0005, le=1)
    join_mm: Number = Field(0.1, ge=0.001, le=2)  # ends that are nearer than this to another line are moved onto it
    # the face of the fabric that carries the plastic of all lines without one of their own; above by default
    side: Side | None = None
    rounding: Rounding | None = None  # rounds thickness and width of every line to what a printer can make

    @model_validator(mode="after")
    def _has_a_line(self) -> Self:
        if not self.draw and not self.motif and not self.imported:
            raise DesignError("", "must have a line: [[rods.draw]], [[rods.import]] or [[rods.motif]]")
        return self

    @property
    def on_sheet(self) -> tuple[DrawnLine, ...]:
        """The lines on the sheet, drawn here and imported."""
        return (*self.draw, *(line for drawing in self.imported for line in drawing.drawn()))

    def size_of(self, line: DrawnLine, key: str) -> SizingField:
        """A size of a line: its own, or else that of all lines."""
        own: SizingField | None = getattr(line, key)
        shared: SizingField = getattr(self, key)
        return shared if own is None else own

    def face(self, line: DrawnLine) -> int:
        """1 for a line above the fabric, -1 for one below."""
        return FACES[line.side or self.side]
