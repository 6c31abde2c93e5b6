"""`asterism law show`: a law as text and picture."""

from __future__ import annotations

import json
from pathlib import Path

from asterism.homogenize.law.law_file import PAPER_LAW, load_law
from asterism.laws.law_picture import draw_law
from asterism.laws.law_text import held_out_warning, law_lines, law_record
from asterism.results.files import check_writable, staged_result


def show_law(path: Path | None, output: Path | None) -> list[str]:
    """Write law.png and summary.json; the lines to print.

    Parameters
    ----------
    path : of the law; None for the paper's.
    output : the folder; by default beside the law.

    Raises
    ------
    LawError
        The file is not a law, or has another format.
    """
    law = load_law(path or PAPER_LAW)
    directory = output or (Path("paper-law") if path is None else _beside(path))
    check_writable(directory)
    with staged_result(directory) as folder:
        draw_law(law, folder / "law.png")
        text = json.dumps(law_record(law).to_json(), indent=1, allow_nan=False) + "\n"
        (folder / "summary.json").write_text(text, encoding="utf-8")
    return [*law_lines(law), f"{directory}: law.png, summary.json"]


def law_doubts(path: str | Path | None = None) -> list[str]:
    """The reasons for which a law is not reliable: it misses its held-out cells."""
    law = load_law(path or PAPER_LAW)
    return [line for line in (held_out_warning(law),) if line]


def _beside(path: Path) -> Path:
    """The folder beside a law. Its name differs from that of a design's results, which is the design's name."""
    return path.with_name(path.stem if path.stem.endswith("law") else f"{path.stem}-law")
