"""One file for a law: arrays and texts in a numpy archive, without pickles.

It holds the tables, and everything needed to make them again: the material with its plan and mesh edge, versions and
command, all samples, and the residuals.
"""

from __future__ import annotations

import hashlib
import io
import json
import tokenize
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from homogenize.cell.corrugation_waves import CorrugationWaves
from homogenize.errors import LawError
from homogenize.law.anisotropy import anisotropy_size
from homogenize.law.hermite_grid import Floats
from homogenize.law.law import Law
from homogenize.law.law_table import QUANTITY_NAMES, LawTable, to_stored
from homogenize.law.material import Material
from pattern.design.errors import DesignError

# raised when a file's arrays or quantities mean something else than before
LAW_FORMAT = 4
PAPER_LAW = Path(__file__).parents[1] / "data" / "paper.npz"
_TEXTS = ("material", "residuals", "made")


class PackedRows(Sequence[Any]):
    """A list as JSON, compressed until someone asks for it: a preview never asks for the cells of its law."""

    def __init__(self, packed: bytes) -> None:
        self.packed = packed

    @classmethod
    def of(cls, rows: Sequence[Any]) -> PackedRows:
        """The rows, packed; themselves if they are."""
        return rows if isinstance(rows, cls) else cls(zlib.compress(json.dumps(list(rows)).encode()))

    @cached_property
    def _rows(self) -> list[Any]:
        rows = json.loads(zlib.decompress(self.packed))
        return rows if isinstance(rows, list) else []

    def __len__(self) -> int:
        return len(self._rows)

    def __getitem__(self, number: Any) -> Any:
        return self._rows[number]


def law_bytes(law: Law) -> bytes:
    """The content of the law's file; equal laws made in the same run time give equal bytes."""
    texts: dict[str, Any] = {
        "material": law.material.to_dict(),
        "residuals": law.residuals,
        "made": law.made,
    }
    arrays: dict[str, np.ndarray] = {"format": np.array(LAW_FORMAT), "names": np.array(QUANTITY_NAMES)}
    arrays |= {name: np.frombuffer(json.dumps(text).encode(), np.uint8) for name, text in texts.items()}
    arrays["samples"] = np.frombuffer(PackedRows.of(law.samples).packed, np.uint8)
    for number, table in enumerate(law.tables):
        arrays |= {f"{number}/{name}": array for name, array in _arrays(table).items()}
    stream = io.BytesIO()
    np.savez_compressed(stream, allow_pickle=False, **arrays)  # type: ignore[arg-type]
    return stream.getvalue()


# what the readers of archives raise for files that are none, or damaged
DAMAGED_FILE_ERRORS = (
    KeyError,
    TypeError,
    ValueError,
    EOFError,
    RuntimeError,
    tokenize.TokenError,
    zipfile.BadZipFile,
    zlib.error,
)


def law_digest(law: Law) -> str:
    """Hash of all that a law says: the same for the same plan, however and whenever it was computed."""
    parts = [json.dumps([law.material.to_dict(), list(law.samples), law.residuals], sort_keys=True).encode()]
    parts += [array.tobytes() for table in law.tables for array in _arrays(table).values()]
    return hashlib.sha256(b"".join(parts)).hexdigest()[:16]


def load_law(path: str | Path | None = None) -> Law:
    """A law from its file; the paper's material's, which comes with the package, by default.

    Raises
    ------
    LawError
        The file is not a law, or one of another format; one line.
    """
    path = PAPER_LAW if path is None else Path(path)
    try:
        with np.load(path, allow_pickle=False) as archive:
            if "format" not in archive:
                raise LawError(f"{path}: is not a law")
            if (known := int(archive["format"])) != LAW_FORMAT:
                other = f"has format {known}, this version reads {LAW_FORMAT}"
                raise LawError(f"{path}: {other}; make it again: asterism calibrate")
            if tuple(archive["names"]) != QUANTITY_NAMES:
                raise LawError(f"{path}: holds other quantities than this version; make it again: asterism calibrate")
            samples = PackedRows(archive["samples"].tobytes())
            material, residuals, made = (json.loads(archive[name].tobytes()) for name in _TEXTS)
            count = len({name.split("/")[0] for name in archive.files if "/" in name})
            if not (isinstance(residuals, dict) and isinstance(made, dict)):
                raise ValueError("texts that are no tables")
            tables = tuple(_table({k: archive[f"{n}/{k}"] for k in _named(archive, n)}) for n in range(count))
        law = Law(Material.from_dict(material), tables, samples, residuals, made)
        _check_whole(law)
        if any(table.anisotropies.shape[-1] != anisotropy_size(law.material.lattice) for table in law.tables):
            raise LawError(f"{path}: lacks what differs between directions; make it again: asterism calibrate")
        if anisotropy_size(law.material.lattice) and not all("tubes" in kinds for kinds in residuals.values()):
            raise LawError(f"{path}: lacks how many of its cells are stable; make it again: asterism calibrate")
        return law
    except OSError as error:
        raise LawError(f"{path}: cannot be read: {error.strerror or error}") from None
    except DesignError as error:
        raise LawError(f"{path}: its material cannot be read: {error}; make it again: asterism calibrate") from None
    except DAMAGED_FILE_ERRORS as error:
        if isinstance(error, LawError):
            raise
        raise LawError(f"{path}: is not a law, or damaged") from None


def _check_whole(law: Law) -> None:
    """Raise ValueError if the parts of a law are not of each other."""
    stretches = tuple(table.stretch for table in law.tables)
    known = all("errors" in kinds["held_out"] for kinds in law.residuals.values())
    waves = len(CorrugationWaves.of(law.material.lattice))
    if stretches != law.material.stretches or not known or any(t.reliefs.shape[-1] != waves for t in law.tables):
        raise ValueError("tables, residuals and material are not of one law")


_OPTIONAL = "anisotropies"  # left out where directions do not differ
_ARRAYS = ("stretch", "spacing_mm", "length_mm", "thickness_mm", "width_mm", "nodes", "reliefs", "good", "units")


def _named(archive: Mapping[str, Any], number: int) -> list[str]:
    """The arrays of a table in a file."""
    return [*_ARRAYS, _OPTIONAL] if f"{number}/{_OPTIONAL}" in archive else list(_ARRAYS)


def _arrays(table: LawTable) -> dict[str, np.ndarray]:
    numbers = (np.array(table.stretch), np.array(table.spacing_mm))
    values = (*numbers, *table.axes, table.nodes, table.reliefs, table.good, table.units)
    found = dict(zip(_ARRAYS, values, strict=True))
    return found | ({_OPTIONAL: table.anisotropies} if table.anisotropies.size else {})


def _table(arrays: dict[str, np.ndarray]) -> LawTable:
    axes: tuple[Floats, Floats, Floats] = (arrays["length_mm"], arrays["thickness_mm"], arrays["width_mm"])
    shape = tuple(len(axis) for axis in axes)
    directional = arrays.get(_OPTIONAL, np.empty((*shape, 0)))
    fit = arrays["nodes"].shape == (*shape, len(QUANTITY_NAMES)) and shape == arrays["good"].shape
    fit = (
        fit
        and arrays["good"].dtype == bool
        and arrays["reliefs"].ndim == 5
        and arrays["reliefs"].shape[:4] == (*shape, 2)
        and directional.shape[:-1] == shape
    )
    if not fit or not all(np.isfinite(array).all() for array in arrays.values()):
        raise ValueError("arrays do not fit together, or have gaps")
    if not all((np.diff(axis) > 0).all() for axis in axes) or min(axes[1][0], axes[2][0]) <= 0 or axes[0][0] < 0:
        raise ValueError("sizes do not increase from one to the next, or are none")
    stretch, spacing = float(arrays["stretch"]), float(arrays["spacing_mm"])
    with np.errstate(all="ignore"):  # what comes of it is looked at
        stored = to_stored(arrays["nodes"], arrays["units"])
    if not (np.isfinite(stored).all() and stretch > 0 and spacing > 0):
        raise ValueError("values that no cell has")
    values, reliefs, good, unit = (arrays[name] for name in ("nodes", "reliefs", "good", "units"))
    return LawTable(stretch, spacing, axes, values, reliefs, good, unit, directional)
