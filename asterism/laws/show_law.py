"""`asterism law show`: a law as text, picture and numbers."""

from __future__ import annotations

import json
from pathlib import Path

from asterism.homogenize.law.any_law import load_any_law
from asterism.homogenize.law.law_file import PAPER_LAW
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.laws.law_picture import draw_law
from asterism.laws.law_record import cells_csv, law_record
from asterism.laws.law_text import law_lines
from asterism.laws.motif_law_picture import draw_motif_law
from asterism.laws.motif_law_record import motif_cells_csv, motif_law_record
from asterism.laws.motif_law_text import motif_law_doubts, motif_law_lines
from asterism.previews.law_warnings import held_out_warning
from asterism.results.files import check_writable, staged_result


def show_law(path: Path | None, output: Path | None) -> list[str]:
    """Write law.png, cells.csv and summary.json; the lines to print.

    Parameters
    ----------
    path : of the law; None for the paper's.
    output : the folder; by default beside the law.

    Raises
    ------
    LawError
        The file is not a law, or has another format.
    """
    law = load_any_law(path or PAPER_LAW)
    directory = output or (Path("paper-law") if path is None else _beside(path))
    check_writable(directory)
    with staged_result(directory) as folder:
        if isinstance(law, MotifLaw):
            record, cells, lines = motif_law_record(law).to_json(), motif_cells_csv(law), motif_law_lines(law)
            draw_motif_law(law, folder / "law.png")
        else:
            record, cells, lines = law_record(law).to_json(), cells_csv(law), law_lines(law)
            draw_law(law, folder / "law.png")
        (folder / "cells.csv").write_text(cells, encoding="utf-8")
        text = json.dumps(record, indent=1, allow_nan=False) + "\n"
        (folder / "summary.json").write_text(text, encoding="utf-8")
    return [*lines, f"{directory}: law.png, cells.csv, summary.json"]


def law_doubts(path: str | Path | None = None) -> list[str]:
    """The reasons for which a law is not reliable: it misses its held-out cells."""
    law = load_any_law(path or PAPER_LAW)
    if isinstance(law, MotifLaw):
        return motif_law_doubts(law)
    return [line for line in (held_out_warning(law),) if line]


def _beside(path: Path) -> Path:
    """The folder beside a law. Its name differs from that of a design's results, which is the design's name."""
    return path.with_name(path.stem if path.stem.endswith("law") else f"{path.stem}-law")
