"""Intact files from which inputs are mutated: made once, in a folder of their own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

SIX_CORNERS = [[-30.0, -25.0], [30.0, -25.0], [38.0, 0.0], [30.0, 25.0], [-30.0, 25.0], [-38.0, 0.0]]
# small sheets: a case of the exact model takes a second or two
DESIGNS: dict[str, dict[str, Any]] = {
    "star": {"stars": {"length_mm": 10.0, "thickness_mm": 0.4}, "border": {"rings": 0}, "mesh": {"edge_mm": 4.0}},
    "seven": {
        "stars": {"length_mm": {"profile": "radial", "from": 10, "to": 6, "over_mm": 20}, "thickness_mm": 0.35},
        "border": {"rings": 1},
        "mesh": {"edge_mm": 5.0},
    },
    "pinned": {
        "stars": {"length_mm": 9.0, "override": [{"star": 1, "thickness_mm": 0.5}, {"site": [0, 1], "remove": True}]},
        "border": {"rings": 1},
        "pins": [{"corners": [0, 2, 4], "scale": 0.75}],
        "mesh": {"edge_mm": 5.0},
    },
    "square": {
        "lattice": {"kind": "square", "spacing_mm": 18.0, "arms": 4, "orientation_deg": 45.0},
        "stars": {"length_fraction": 0.45, "width_mm": {"formula": "1 + x/200"}},
        "border": {"rectangle_mm": [60.0, 50.0]},
        "mesh": {"edge_mm": 5.0},
    },
    "outline": {
        "fabric": {"stretch": 1.35, "thickness_mm": 0.8, "modulus_mpa": 7.0},
        "stars": {"length_mm": 8.0, "branch": "up"},
        "border": {"polygon_mm": SIX_CORNERS, "star_margin_mm": 8.0},
        "gravity": {"on": True, "direction": [0, 0, -1]},
        "pins": [{"points_mm": [[-30.0, -25.0], [30.0, -25.0], [30.0, 25.0]]}, {"edges": [4], "step": 1}],
        "mesh": {"edge_mm": 6.0, "kind": "delaunay"},
        "solver": {"start": "bump", "seed": 1},
    },
}
MATERIAL = {
    "name": "measured",
    "fabric": {"thickness_mm": 0.8, "stretch": 1.35},
    "plastic": {"modulus_ratio": 3200.0, "rest_curvature": "paper", "kappa_bar_per_mm": 0.0},
}
OUTLINE_CSV = "x_mm,y_mm\n-9,-5\n0,-10\n9,-5\n9,5\n0,10\n-9,5\n"
OUTLINE_SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="30mm" height="30mm" viewBox="0 0 30 30">\n'
    '<path d="M 6 10 L 15 5 L 24 10 L 24 20 L 15 25 L 6 20 Z"/>\n<circle cx="3" cy="3" r="1"/>\n</svg>\n'
)


def strips_csv() -> str:
    """A table of measured strips, with fabric and peeled, whose readings scatter."""
    rng = np.random.default_rng(0)
    lines = ["strip,thickness_mm,length_mm,stretch,fabric_thickness_mm,curvature_per_mm,peeled_curvature_per_mm"]
    for number in range(24):
        thickness, bent = ((0.3, 0.0302), (0.35, 0.0228), (0.4, 0.0175))[number % 3]
        with_fabric, peeled = rng.normal([bent, 0.003], [0.0004, 0.0002])
        lines.append(f"{number + 1},{thickness},60,1.35,0.8,{with_fabric:.5f},{peeled:.5f}")
    return "\n".join(lines) + "\n"


def make_kit(folder: Path) -> None:
    """Write all intact files, and a shape for comparisons with scans."""
    import trimesh

    import asterism
    from asterism.homogenize.law.law_file import PAPER_LAW

    shape = asterism.preview(asterism.Design.from_dict(DESIGNS["star"]))
    asterism.write_results(shape, folder / "shape")
    scan = trimesh.Trimesh(shape.positions, shape.triangles, process=False)
    for suffix in ("obj", "stl", "ply"):
        scan.export(folder / f"scan.{suffix}")
    (folder / "text.ply").write_bytes(scan.export(file_type="ply", encoding="ascii"))
    (folder / "text.stl").write_text(scan.export(file_type="stl_ascii"))
    (folder / "outline.csv").write_text(OUTLINE_CSV)
    (folder / "outline.svg").write_text(OUTLINE_SVG)
    (folder / "strips.csv").write_text(strips_csv())
    (folder / "law.npz").write_bytes(PAPER_LAW.read_bytes())
    profiles = Path(asterism.__file__).parent / "print" / "data"
    (folder / "printer.toml").write_bytes((profiles / "printers" / "ultimaker2.toml").read_bytes())
    (folder / "plastic.toml").write_bytes((profiles / "plastics" / "tpu95a.toml").read_bytes())
