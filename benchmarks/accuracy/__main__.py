"""The preview against the exact model: 20 designs of the gallery and 24 at random.

python -m benchmarks.accuracy FOLDER [--starts] [--kept] [--law LAW.npz] [NAME ...]

FOLDER keeps the exact shapes. It keeps finished comparisons as long as the law and the code of the preview stay the
same. The exact model starts from the released sheet and from the preview, and the shape of lower energy counts. A shape
that was found from a preview stays a candidate of its design when the preview changes. With `--starts`, iterations and
seconds of both starts are compared too. With names, docs/explanation/accuracy.md stays as it is. With `--kept`,
comparisons in FOLDER are used even if other code has made them, as long as the preview has the same shape; estimates
and warnings are computed anew. `python -m benchmarks.accuracy.finished FOLDER` puts those of
benchmarks/results there.
"""

from __future__ import annotations

import argparse
import hashlib
from pathlib import Path
from typing import Any

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import law_digest, load_law
from asterism.pattern.design.design import Design
from benchmarks.accuracy import report
from benchmarks.accuracy.causes import causes
from benchmarks.accuracy.designs import designs
from benchmarks.accuracy.exact import exact
from benchmarks.accuracy.finished import read_row, restated, row_path, write_row
from benchmarks.accuracy.row import quick_row, whole_row
from benchmarks.laws import law_of
from benchmarks.report import write_report

ROOT = Path(__file__).parents[2]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--starts", action="store_true")
    parser.add_argument("--kept", action="store_true")
    parser.add_argument("--law", type=Path)
    parser.add_argument("names", nargs="*")
    options = parser.parse_intermixed_args()
    law = load_law(options.law) if options.law else load_law()
    rows, left_out = [], {}
    for design in designs():
        if options.names and design.name not in options.names:
            continue
        try:
            law_in_use = law_of(design, law)  # before the exact model takes its time
            if options.kept and not row_path(options.folder, design, options.starts).exists():
                left_out[design.name] = "not compared"
                continue
            rows.append(kept(design, options.folder, law_in_use, options.starts, options.kept))
        except LawError as error:
            left_out[design.name] = str(error)
            continue
        print("  ".join(report.row(rows[-1])), flush=True)
    text = report.section(rows, left_out)
    print(text)
    if not options.names:
        report.plot(rows, report.DOCS / "pictures" / "accuracy.png")
        write_report("accuracy", rows, text.replace("](../pictures/", "](../../docs/pictures/"))
        report.put_into_docs(report.in_brief(rows))


def kept(design: Design, folder: Path, law: Law, starts: bool, as_is: bool) -> dict[str, Any]:
    """The row of a design, from the folder if nothing that makes the preview has changed since."""
    made_by = hashlib.sha256(b"".join([law_digest(law).encode(), *preview_code()])).hexdigest()[:16]
    path = row_path(folder, design, starts)
    row = read_row(path, design)
    if row is not None and row["made_by"] == made_by:
        return row
    if row is not None and as_is and (new_row := restated(row, design, law)):
        new_row |= {"made_by": made_by}
        write_row(path, new_row)
        return new_row
    released = exact(design, folder)
    row = (whole_row if starts else quick_row)(design, folder, law)
    known = causes(design, law) | {"softness": released.summary["smallest_eigenvalue"]}
    row |= {
        "stars": released.summary["stars_total"],
        "causes": known,
        "made_by": made_by,
        "design": design.to_dict(),
    }
    write_row(path, row)
    return row


def preview_code() -> list[bytes]:
    """What a preview is computed and compared by."""
    folders = (ROOT / "fem", ROOT / "asterism" / "previews", ROOT / "asterism" / "shape")
    return [file.read_bytes() for folder in folders for file in sorted(folder.rglob("*.py"))]


if __name__ == "__main__":
    main()
