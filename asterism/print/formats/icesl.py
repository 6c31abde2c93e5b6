"""IceSL: the stars as a table in Lua, in which single stars can be changed by hand."""

from __future__ import annotations

from pathlib import Path

from asterism.print.formats.registry import export_format
from asterism.print.formats.star_table import HEADING, number, star_table
from asterism.print.job import Job
from pattern.design.errors import one_line

_FUNCTIONS = """
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


@export_format("IceSL", ".lua", "script")
def write_icesl(path: Path, job: Job) -> None:
    """Write the stars of a job in the printer's coordinates."""
    lines = [f"-- {one_line(job.design.name)}: stars for the {one_line(job.printer.name)}, in mm", f"-- {HEADING}", ""]
    lines.append("stars = {")
    for (x, y), pieces in star_table(job):
        inner = ", ".join("{" + ", ".join(map(number, piece)) + "}" for piece in pieces)
        lines.append(f"  {{{number(x)}, {number(y)}, {{{inner}}}}},")
    lines.append("}")
    path.write_text("\n".join(lines) + "\n" + _FUNCTIONS, encoding="utf-8", newline="\n")
