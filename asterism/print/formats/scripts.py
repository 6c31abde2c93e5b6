"""Scripts for OpenSCAD and IceSL: a table of the printed pieces, and the code that makes solids of them, in mm."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from asterism.pattern.design.errors import one_line
from asterism.print.formats.registry import export_format
from asterism.print.job import Job

_HEADING = (
    "each line is one of them: x, y of its place, and its pieces with their height, whether begin and end are round, "
    "and the points of the middle line: x, y from that place, width"
)

_OPENSCAD = """
// a straight part of a piece
module straight(a, b) {
    n = [a[1] - b[1], b[0] - a[0]] / norm([b[0] - a[0], b[1] - a[1]]) / 2;
    polygon([
        [a[0], a[1]] - a[2] * n, [b[0], b[1]] - b[2] * n, [b[0], b[1]] + b[2] * n, [a[0], a[1]] + a[2] * n
    ]);
}

module piece(p) {
    last = len(p[3]) - 1;
    linear_extrude(height = p[0]) {
        for (k = [1 : last]) straight(p[3][k - 1], p[3][k]);
        for (k = [0 : last]) if ((k > 0 || p[1] == 1) && (k < last || p[2] == 1))
            translate([p[3][k][0], p[3][k][1]]) circle(d = p[3][k][2], $fn = 32);
    }
}

union() for (part = parts) translate([part[0], part[1]]) for (p = part[2]) piece(p);
"""

_ICESL = """
-- a straight part of a piece as a prism
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

for _, part in ipairs(parts) do
  local whole = nil
  for _, p in ipairs(part[3]) do
    local points, last = {}, #p[4]
    for k, q in ipairs(p[4]) do points[k] = {q[1] + part[1], q[2] + part[2], q[3]} end
    for k = 2, last do
      local one = straight(points[k - 1], points[k], p[1])
      if whole == nil then whole = one else whole = union(whole, one) end
    end
    for k = 1, last do
      if (k > 1 or p[2] == 1) and (k < last or p[3] == 1) then whole = union(whole, round(points[k], p[1])) end
    end
  end
  emit(whole)
end
"""


@export_format("OpenSCAD", ".scad", "script")
def write_openscad(path: Path, job: Job) -> None:
    """Write the stars and drawn rods of a job in the printer's coordinates."""
    _write(path, job, "//", "[]", ";", _OPENSCAD)


@export_format("IceSL", ".lua", "script")
def write_icesl(path: Path, job: Job) -> None:
    """Write the stars and drawn rods of a job in the printer's coordinates."""
    _write(path, job, "--", "{}", "", _ICESL)


def _write(path: Path, job: Job, comment: str, brackets: str, end: str, code: str) -> None:
    """Write the table with the comments and the brackets of a language, then its code."""

    def listed(parts: Iterable[str]) -> str:
        return brackets[0] + ", ".join(parts) + brackets[1]

    rows: dict[int, list[str]] = {}
    plan, middle = job.plan, job.printer.bed_centre_mm
    origins = job.placement.points(plan.centres) + middle  # of the parts: the arms of a star are one
    for piece in (*job.arms, *job.rods):
        is_arm = piece.number < len(plan.arm_star)
        part = int(plan.arm_star[piece.number]) if is_arm else len(plan.centres) + piece.number
        origin = origins[part] if is_arm else np.zeros(2)
        places = job.placement.points(piece.points) + middle - origin
        points = [listed(map(_number, row)) for row in np.column_stack([places, piece.width])]
        row = rows.setdefault(part, list(map(_number, origin)))
        row.append(listed([*map(_number, (piece.height_mm, *piece.round_ends)), listed(points)]))
    title = f"{one_line(job.design.name)}: {job.printed_word} for the {one_line(job.printer.name)}, in mm"
    lines = [f"{comment} {title}", f"{comment} {_HEADING}", "", f"parts = {brackets[0]}"]
    lines += [*(f"  {listed([*row[:2], listed(row[2:])])}," for row in rows.values()), brackets[1] + end]
    path.write_text("\n".join(lines) + f"\n{code}", encoding="utf-8", newline="\n")


def _number(value: float) -> str:
    """Up to six digits after the point, as OpenSCAD and Lua read them."""
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
