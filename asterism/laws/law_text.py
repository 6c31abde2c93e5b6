"""A law as lines of text: its range, some of its values, its errors."""

from __future__ import annotations

from collections import Counter

from asterism.homogenize.law.axes import AXES
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_residuals import unstable_tubes
from asterism.homogenize.law.law_table import QUANTITY_NAMES, LawTable
from asterism.laws.law_record import law_record
from asterism.previews.law_warnings import (
    directions_warning,
    held_out_warning,
    mesh_warning,
    pleat_warning,
    symmetry_warning,
)
from asterism.process.count_line import without_numbers
from asterism.results.words import table_lines

# approximate numbers of nodes of the first two axes in the table of values
LISTED_LENGTHS = 4
LISTED_THICKNESSES = 3
# characters of a label in the first lines
MATERIAL_COLUMN = 11


def law_lines(law: Law) -> list[str]:
    """The law as lines of text."""
    lines = []
    for table in law.tables:
        lines += ["", *_values(table), *_errors(law, table)]
    head = table_lines(law_record(law).table(), MATERIAL_COLUMN)
    return [*head, *lines, *_stability(law), *_warnings(law), *_problems(law)]


def middle_sizes(table: LawTable) -> tuple[float, ...]:
    """The middle node of each axis after the first two, which text and pictures vary."""
    return tuple(float(nodes[len(nodes) // 2]) for nodes in table.axis_nodes[2:])


def table_title(table: LawTable) -> str:
    """The stretch of a table and its middle sizes, such as "stretch 1.35, width 1.2 mm"."""
    sizes = zip(AXES[2:], middle_sizes(table), strict=True)
    return ", ".join([f"stretch {table.stretch:g}", *(f"{axis.name} {size:g} mm" for axis, size in sizes)])


def _values(table: LawTable) -> list[str]:
    lengths, thicknesses = table.axis_nodes[:2]
    (length_name, thickness_name) = (f"{axis.symbol} mm" for axis in AXES[:2])
    lines = [
        f"  {table_title(table)}",
        f"    {length_name}   {thickness_name}  lambda lambda_n   kappa 1/mm  D N mm  A11 N/mm  A12 N/mm  c3 N mm2  "
        "offset mm",
    ]
    for length in lengths[1:][:: max(1, (len(lengths) - 1) // LISTED_LENGTHS)]:
        for thickness in thicknesses[:: max(1, (len(thicknesses) - 1) // LISTED_THICKNESSES)]:
            row = table(length, thickness, *middle_sizes(table))
            v = {name: float(row.value[name][0]) for name in QUANTITY_NAMES}
            numbers = (
                f"{v['lam']:.4f}   {v['lam_n']:.4f}     {v['kappa']:8.5f} {v['bending']:7.3f} {v['a11']:9.3f} "
                f"{v['a12']:9.3f} {v['c3']:9.3f} {v['offset_mm']:10.3f}"
            )
            mark = "  not scale-separated" if row.not_scale_separated[0] else ""
            lines.append(f"  {length:6.2f} {thickness:6.3f}  " + (numbers + mark if row.inside[0] else "no answer"))
    return lines


def _errors(law: Law, table: LawTable) -> list[str]:
    lines = []
    for kind, entry in law.residuals.get(f"{table.stretch:g}", {}).items():
        if "errors" not in entry:
            continue
        errors = entry["errors"]
        title = f"  {kind.replace('_', ' ')}, {entry['count']} cells; error in % of the cell's value"
        if entry.get("tight", {}).get("count"):
            title += f"; {entry['tight']['count']} more are not scale-separated"
        lines += ["", title + ("" if errors else ": none"), *([f"  {'':11} median    rms  largest"] if errors else [])]
        for name in QUANTITY_NAMES if errors else ():
            e = errors[name]
            lines.append(
                f"    {name:<10} {e['median_percent']:5.2f} {e['rms_percent']:6.2f} {e['largest_percent']:8.2f}"
            )
    return lines


def _stability(law: Law) -> list[str]:
    """Numbers of stable cells; cells.csv has the eigenvalues of each cell."""
    solved = [s["sample"] for s in law.samples if s["problem"] is None and s["length_mm"] > 0]
    if not solved:
        return []
    count = len(solved)
    flat = sum(sample["supercell_eigenvalue"] > 0 for sample in solved)
    tubes = count - unstable_tubes(law.samples)["unstable"]
    down = sum(sample["down_energy"] is not None for sample in solved)
    anisotropy = max(sample["anisotropy"] for sample in solved)
    return [
        "",
        f"  natural tubes that are stable on 2 x 2 stars: {tubes} of {count} cells",
        f"  flat cells that are stable on 2 x 2 stars: {flat}; flat cells with a second equilibrium, star down: {down}",
        f"  flat stiffness, distance from isotropy: at most {anisotropy:.1e}",
    ]


def _warnings(law: Law) -> list[str]:
    warnings = (
        directions_warning(law),
        held_out_warning(law),
        mesh_warning(law),
        symmetry_warning(law),
        pleat_warning(law),
    )
    lines = [line for line in warnings if line]
    return ["", *(f"  {line}" for line in lines)] if lines else []


def _problems(law: Law) -> list[str]:
    """The reasons why cells have no equilibrium, without their numbers, and how often each occurs."""
    reasons = Counter(without_numbers(s["problem"]) for s in law.samples if s["problem"] is not None)
    lines = [f"    {count:4d}  {reason}" for reason, count in reasons.most_common()]
    return ["", "  cells without an answer", *lines] if lines else []
