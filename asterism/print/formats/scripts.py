"""OpenSCAD and IceSL: stars and drawn rods as tables, in which single ones can be changed by hand."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path

import numpy as np

from asterism.pattern.design.errors import one_line
from asterism.print.formats.registry import export_format
from asterism.print.job import Job

HEADING = "x, y of the centre; for every piece of an arm its angle (deg), begin, end, width there and there, height"
ROD_HEADING = "height, whether the beginning and the end are round, and the points of the middle line: x, y, width"

_STAR_MODULES = """
module strip(p) {
    rotate(p[0]) linear_extrude(height = p[5])
        polygon([[p[1], -p[3] / 2], [p[2], -p[4] / 2], [p[2], p[4] / 2], [p[1], p[3] / 2]]);
    if (p[1] == 0) cylinder(d = p[3], h = p[5], $fn = 32);
}

module star(s) {
    translate([s[0], s[1], 0]) for (p = s[2]) strip(p);
}
"""

_ROD_MODULES = """
// a straight piece of a rod
module straight(a, b) {
    n = [a[1] - b[1], b[0] - a[0]] / norm([b[0] - a[0], b[1] - a[1]]) / 2;
    polygon([
        [a[0], a[1]] - a[2] * n, [b[0], b[1]] - b[2] * n, [b[0], b[1]] + b[2] * n, [a[0], a[1]] + a[2] * n
    ]);
}

module rod(r) {
    last = len(r[3]) - 1;
    linear_extrude(height = r[0]) {
        for (k = [1 : last]) straight(r[3][k - 1], r[3][k]);
        for (k = [0 : last]) if ((k > 0 || r[1] == 1) && (k < last || r[2] == 1))
            translate([r[3][k][0], r[3][k][1]]) circle(d = r[3][k][2], $fn = 32);
    }
}
"""

_STAR_FUNCTIONS = """
-- a piece of an arm as a prism
local function strip(x, y, p)
  local a = math.rad(p[1])
  local tx, ty = math.cos(a), math.sin(a)
  local function corner(along, aside)
    return v(x + along * tx - aside * ty, y + along * ty + aside * tx, 0)
  end
  local outline = {
    corner(p[2], -p[4] / 2), corner(p[3], -p[5] / 2), corner(p[3], p[5] / 2), corner(p[2], p[4] / 2),
  }
  return linear_extrude(v(0, 0, p[6]), outline)
end

-- the round middle of a star
local function disc(x, y, p)
  local outline = {}
  for k = 1, 32 do
    local a = 2 * math.pi * k / 32
    outline[k] = v(x + p[4] / 2 * math.cos(a), y + p[4] / 2 * math.sin(a), 0)
  end
  return linear_extrude(v(0, 0, p[6]), outline)
end

for _, s in ipairs(stars) do
  local whole = nil
  for _, p in ipairs(s[3]) do
    local part = strip(s[1], s[2], p)
    if p[2] == 0 then part = union(part, disc(s[1], s[2], p)) end
    if whole == nil then whole = part else whole = union(whole, part) end
  end
  emit(whole)
end
"""

_ROD_FUNCTIONS = """
-- a straight piece of a rod as a prism
local function straight(a, b, height)
  local far = math.sqrt((b[1] - a[1])^2 + (b[2] - a[2])^2)
  local nx, ny = (a[2] - b[2]) / far / 2, (b[1] - a[1]) / far / 2
  local outline = {
    v(a[1] - a[3] * nx, a[2] - a[3] * ny, 0), v(b[1] - b[3] * nx, b[2] - b[3] * ny, 0),
    v(b[1] + b[3] * nx, b[2] + b[3] * ny, 0), v(a[1] + a[3] * nx, a[2] + a[3] * ny, 0),
  }
  return linear_extrude(v(0, 0, height), outline)
end

-- a round corner or end
local function round(p, height)
  local outline = {}
  for k = 1, 32 do
    local a = 2 * math.pi * k / 32
    outline[k] = v(p[1] + p[3] / 2 * math.cos(a), p[2] + p[3] / 2 * math.sin(a), 0)
  end
  return linear_extrude(v(0, 0, height), outline)
end

for _, r in ipairs(rods) do
  local points, last, whole = r[4], #r[4], nil
  for k = 2, last do
    local part = straight(points[k - 1], points[k], r[1])
    if whole == nil then whole = part else whole = union(whole, part) end
  end
  for k = 1, last do
    if (k > 1 or r[2] == 1) and (k < last or r[3] == 1) then whole = union(whole, round(points[k], r[1])) end
  end
  emit(whole)
end
"""


@export_format("OpenSCAD", ".scad", "script")
def write_openscad(path: Path, job: Job) -> None:
    """Write the stars and drawn rods of a job in the printer's coordinates."""
    union = []
    if job.arms:
        union.append("for (s = stars) star(s);")
    if job.rods:
        union.append("for (r = rods) rod(r);")
    whole = "{ " + " ".join(union) + " }" if len(union) > 1 else union[0]
    _write(path, job, "//", "[", "];", _STAR_MODULES, _ROD_MODULES, f"\nunion() {whole}\n")


@export_format("IceSL", ".lua", "script")
def write_icesl(path: Path, job: Job) -> None:
    """Write the stars and drawn rods of a job in the printer's coordinates."""
    _write(path, job, "--", "{", "}", _STAR_FUNCTIONS, _ROD_FUNCTIONS, "")


def _write(path: Path, job: Job, comment: str, opening: str, closing: str, stars: str, rods: str, end: str) -> None:
    """Write the tables with the brackets and the comments of a language, then its code for stars and for rods."""
    listed = partial(_listed, opening=opening, closing=closing[0])
    title = f"{one_line(job.design.name)}: {job.printed_word} for the {one_line(job.printer.name)}, in mm"
    lines, code = [f"{comment} {title}"], ""
    for name, heading, rows, own in (
        ("stars", HEADING, _star_rows(job, listed) if job.arms else [], stars),
        ("rods", ROD_HEADING, _rod_rows(job, listed), rods),
    ):
        if rows:
            lines += [f"{comment} {heading}", "", f"{name} = {opening}", *(f"  {row}," for row in rows), closing]
            code += own
    path.write_text("\n".join(lines) + f"\n{code}{end}", encoding="utf-8", newline="\n")


def _star_rows(job: Job, listed: Callable[[Iterable[str]], str]) -> list[str]:
    """For each star its centre in the printer's coordinates, and its pieces: angle, begin, end, widths, height."""
    pieces: list[list[str]] = [[] for _ in job.plan.centres]
    for piece in job.arms:
        star = job.plan.arm_star[piece.number]
        x, y = piece.points[1] - piece.points[0]
        angle = math.degrees(math.atan2(y, x)) + job.placement.turn_deg
        ends = (math.dist(point, job.plan.centres[star]) for point in piece.points)
        pieces[star].append(listed(map(_number, (angle, *ends, *piece.width, piece.height_mm))))
    centres = job.placement.points(job.plan.centres) + job.printer.bed_centre_mm
    return [listed([*map(_number, at), listed(own)]) for at, own in zip(centres, pieces, strict=True)]


def _rod_rows(job: Job, listed: Callable[[Iterable[str]], str]) -> list[str]:
    """For each piece of a drawn rod its height, ends and points, in the printer's coordinates."""
    rows = []
    for piece in job.rods:
        places = job.placement.points(piece.points) + job.printer.bed_centre_mm
        points = [listed(map(_number, row)) for row in np.column_stack([places, piece.width])]
        rows.append(listed([*map(_number, (piece.height_mm, *piece.round_ends)), listed(points)]))
    return rows


def _listed(parts: Iterable[str], opening: str, closing: str) -> str:
    return opening + ", ".join(parts) + closing


def _number(value: float) -> str:
    """Up to six digits after the point, as OpenSCAD and Lua read them."""
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
