"""IceSL: stars and drawn rods as tables in Lua, in which single ones can be changed by hand."""

from __future__ import annotations

from pathlib import Path

from asterism.pattern.design.errors import one_line
from asterism.print.formats.registry import export_format
from asterism.print.formats.script_tables import HEADING, ROD_HEADING, rod_table, star_table
from asterism.print.job import Job

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


@export_format("IceSL", ".lua", "script")
def write_icesl(path: Path, job: Job) -> None:
    """Write the stars and drawn rods of a job in the printer's coordinates."""
    lines = [f"-- {one_line(job.design.name)}: {job.printed_word} for the {one_line(job.printer.name)}, in mm"]
    functions = ""
    if job.arms:
        lines += [f"-- {HEADING}", "", "stars = {", *star_table(job, "{", "}"), "}"]
        functions += _STAR_FUNCTIONS
    if job.rods:
        lines += [f"-- {ROD_HEADING}", "", "rods = {", *rod_table(job, "{", "}"), "}"]
        functions += _ROD_FUNCTIONS
    path.write_text("\n".join(lines) + "\n" + functions, encoding="utf-8", newline="\n")
