"""The file of the law of a motif: arrays and texts in a numpy archive, without pickles.

It holds the table and everything that produced it: the plan with the design of its cell, versions and command, all
samples, and the errors.
"""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law_file import DAMAGED_FILE_ERRORS, KIND, PackedRows, law_file_errors
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.motif_plan import MotifPlan
from asterism.homogenize.law.motif_table import MotifTable
from asterism.homogenize.law.tensor_forms import STORED_SIZE
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.files import check_regular

MOTIF_KIND = "motif"
# raise it when the arrays of a file change their meaning
MOTIF_LAW_FORMAT = 1
_TEXTS = ("plan", "residuals", "made")
_REMEDY = "make it again: asterism calibrate"


def motif_law_bytes(law: MotifLaw) -> bytes:
    """The content of the law's file. Equal laws give equal bytes."""
    texts: dict[str, Any] = {"plan": law.plan.to_dict(), "residuals": law.residuals, "made": law.made}
    arrays: dict[str, Any] = {KIND: np.array(MOTIF_KIND), "format": np.array(MOTIF_LAW_FORMAT)}
    arrays |= {name: np.frombuffer(json.dumps(text).encode(), np.uint8) for name, text in texts.items()}
    arrays["samples"] = np.frombuffer(PackedRows.of(law.samples).packed, np.uint8)
    arrays |= {"stored": law.table.stored, "solved": law.table.solved}
    stream = io.BytesIO()
    np.savez_compressed(stream, allow_pickle=False, **arrays)
    return stream.getvalue()


def motif_law_digest(law: MotifLaw) -> str:
    """Hash of table, plan, samples and errors. It does not depend on where and when the law was computed."""
    text = json.dumps(
        [law.plan.to_dict(), [_without_time(each) for each in law.samples], law.residuals], sort_keys=True
    )
    parts = [text.encode(), law.table.stored.tobytes(), law.table.solved.tobytes()]
    return hashlib.sha256(b"".join(parts)).hexdigest()[:16]


def load_motif_law(path: str | Path) -> MotifLaw:
    """The law of a motif from its file.

    Raises
    ------
    LawError
        The file is damaged, is not the law of a motif, or has another format; one line.
    UnreadableLaw
        The file is missing, or cannot be read.
    """
    with law_file_errors(path, "plan", _REMEDY):
        check_regular(Path(path))
        with np.load(path, allow_pickle=False) as archive:
            return _law(archive, path)


def is_motif_law(path: str | Path) -> bool:
    """Whether a file holds the law of a motif. False also for files that cannot be read."""
    try:
        check_regular(Path(path))
        with np.load(path, allow_pickle=False) as archive:
            return KIND in archive and str(archive[KIND]) == MOTIF_KIND
    except (OSError, DesignError, *DAMAGED_FILE_ERRORS):
        return False


def _law(archive: Mapping[str, Any], path: str | Path) -> MotifLaw:
    if KIND not in archive or str(archive[KIND]) != MOTIF_KIND:
        raise LawError(
            f"{path}: is the law of stars, not of a motif" if "names" in archive else f"{path}: is not a law"
        )
    if (version := int(archive["format"])) != MOTIF_LAW_FORMAT:
        raise LawError(f"{path}: has format {version}, this version reads {MOTIF_LAW_FORMAT}; {_REMEDY}")
    data, residuals, made = (json.loads(archive[name].tobytes()) for name in _TEXTS)
    if not (isinstance(residuals, dict) and "errors" in residuals["held_out"] and isinstance(made, dict)):
        raise ValueError("errors or origin are not tables")
    plan = MotifPlan.from_dict(data)
    nodes = tuple(np.array(size.nodes) for size in plan.sizes)
    shape = tuple(len(each) for each in nodes)
    stored, solved = archive["stored"], archive["solved"]
    if stored.shape != (*shape, STORED_SIZE) or solved.shape != shape or solved.dtype != bool:
        raise ValueError("arrays do not fit together")
    if not np.isfinite(stored).all() or not all((np.diff(each) > 0).all() and each[0] > 0 for each in nodes):
        raise ValueError("arrays have gaps, or sizes do not increase")
    return MotifLaw(
        plan, MotifTable(nodes, stored, solved), PackedRows(archive["samples"].tobytes(), path), residuals, made
    )


def _without_time(sample: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in sample.items() if name != "seconds"}
