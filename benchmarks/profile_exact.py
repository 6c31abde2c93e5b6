"""Where the time of a whole exact solve goes.

python -m benchmarks.profile_exact [divisions ...]

The gallery's tube with so many edges between two stars (12: 6487 vertices, 16: 11719, 36: 58381); 16g: graded, with
the plate.
"""

from __future__ import annotations

import cProfile
import pstats
import sys

from asterism.exact.simulation import exact_shape
from asterism.pattern.design.design import Design
from benchmarks.large import tube
from benchmarks.report import markdown

FACTORS = ("/factor.py", "/pardiso.py")
# functions whose time, with all they call, is one row; that of the smooth surface has a reconstruction in it, with
# its analysis and solve, and the others do not call each other
PARTS = {
    "factorisations": (FACTORS, "factorise"),
    "solves": (FACTORS, "solve"),
    "analysis of patterns": (FACTORS, "__init__"),
    "sparsity patterns": ("/sparse_pattern.py", "__init__"),
    "Hessians": ("/system.py", "hessian"),
    "gradients": ("/system.py", "full_gradient"),
    "energies": ("/system.py", "energies"),
    "supports": ("/system.py", "support"),
    "meshes": ("/meshing.py", "mesh_layout"),
    "smooth surface through the coarse mesh": ("/prolongation.py", "prolonged"),
    "set-up of turning steps": ("/reconstruction.py", "path"),
}


def design(word: str) -> Design:
    """The tube of a word of the command line."""
    even = tube(int(word.rstrip("g")))
    if not word.endswith("g"):
        return even
    data = even.to_dict()
    data["mesh"] |= {"graded": True}
    data["fabric"] |= {"bending": "consistent"}
    return Design.from_dict(data)


def profile(word: str) -> tuple[int, float, dict[str, float]]:
    """Vertices, seconds of all, and seconds by part."""
    recorder = cProfile.Profile()
    recorder.enable()
    summary = exact_shape(design(word)).summary
    recorder.disable()
    stats = pstats.Stats(recorder).stats  # type: ignore[attr-defined]
    seconds = dict.fromkeys(PARTS, 0.0)
    for (file, _, name), (_, _, _, cumulative, _) in stats.items():
        for part, (where, what) in PARTS.items():
            if name == what and file.endswith(where):
                seconds[part] += cumulative
    return summary["vertices"], summary["wall_s"], seconds


def main(words: list[str]) -> None:
    for word in ("5", "5g"):
        exact_shape(design(word))  # compiled loops and MKL are loaded now
    found = [profile(word) for word in words or ("12", "16", "36")]
    header = ["seconds", *(f"{vertices} vertices" for vertices, _, _ in found)]
    rows = [[part, *(f"{seconds[part]:.2f}" for _, _, seconds in found)] for part in PARTS]
    rows.append(["whole", *(f"{wall:.2f}" for _, wall, _ in found)])
    print(markdown(header, rows))


if __name__ == "__main__":
    main(sys.argv[1:])
