"""OpenSCAD: the stars as a table, in which single stars can be changed by hand."""

from __future__ import annotations

from pathlib import Path

from asterism.print.formats.registry import export_format
from asterism.print.formats.star_table import HEADING, number, star_table
from asterism.print.job import Job
from pattern.design.errors import one_line

_MODULES = """
module strip(p) {
    rotate(p[0]) linear_extrude(height = p[5])
        polygon([[p[1], -p[3] / 2], [p[2], -p[4] / 2], [p[2], p[4] / 2], [p[1], p[3] / 2]]);
    if (p[1] == 0) cylinder(d = p[3], h = p[5], $fn = 32);
}

module star(s) {
    translate([s[0], s[1], 0]) for (p = s[2]) strip(p);
}

union() for (s = stars) star(s);
"""


@export_format("OpenSCAD", ".scad", "script")
def write_openscad(path: Path, job: Job) -> None:
    """Write the stars of a job in the printer's coordinates."""
    lines = [f"// {one_line(job.design.name)}: stars for the {one_line(job.printer.name)}, in mm", f"// {HEADING}", ""]
    lines.append("stars = [")
    for (x, y), pieces in star_table(job):
        inner = ", ".join("[" + ", ".join(map(number, piece)) + "]" for piece in pieces)
        lines.append(f"  [{number(x)}, {number(y)}, [{inner}]],")
    lines.append("];")
    path.write_text("\n".join(lines) + "\n" + _MODULES, encoding="utf-8", newline="\n")
