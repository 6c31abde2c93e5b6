"""OpenSCAD: stars and drawn rods as tables, in which single ones can be changed by hand."""

from __future__ import annotations

from pathlib import Path

from asterism.pattern.design.errors import one_line
from asterism.print.formats.registry import export_format
from asterism.print.formats.script_tables import HEADING, ROD_HEADING, rod_table, star_table
from asterism.print.job import Job

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


@export_format("OpenSCAD", ".scad", "script")
def write_openscad(path: Path, job: Job) -> None:
    """Write the stars and drawn rods of a job in the printer's coordinates."""
    lines = [f"// {one_line(job.design.name)}: {job.printed_word} for the {one_line(job.printer.name)}, in mm"]
    modules, union = "", []
    if job.arms:
        lines += [f"// {HEADING}", "", "stars = [", *star_table(job, "[", "]"), "];"]
        modules += _STAR_MODULES
        union.append("for (s = stars) star(s);")
    if job.rods:
        lines += [f"// {ROD_HEADING}", "", "rods = [", *rod_table(job, "[", "]"), "];"]
        modules += _ROD_MODULES
        union.append("for (r = rods) rod(r);")
    whole = "union() { " + " ".join(union) + " }" if len(union) > 1 else f"union() {union[0]}"
    path.write_text("\n".join(lines) + f"\n{modules}\n{whole}\n", encoding="utf-8", newline="\n")
