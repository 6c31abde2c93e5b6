"""The file of a law: arrays and texts in a numpy archive, without pickles.

It holds the tables and everything that produced them: the material with its plan and mesh edge, versions and command,
all samples, and the residuals.
"""

from __future__ import annotations

import hashlib
import io
import json
import tokenize
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.cell.corrugation_waves import CorrugationWaves
from asterism.homogenize.errors import LawError, UnreadableLaw
from asterism.homogenize.law.anisotropy import anisotropy_size
from asterism.homogenize.law.axes import AXES
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_table import QUANTITY_NAMES, LawTable, to_stored
from asterism.homogenize.law.material import Material
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.files import check_regular

# raise it when the arrays or quantities of a file change their meaning
LAW_FORMAT = 4
PAPER_LAW = Path(__file__).parents[1] / "data" / "paper.npz"
_REMEDY = "make it again: asterism calibrate"
_TEXTS = ("material", "residuals", "made")
# an array that only the files of other laws have
KIND = "kind"
# names of a table's arrays; the last one is left out for threefold symmetry
_ARRAYS = ("stretch", "spacing_mm", *(axis.key for axis in AXES), "nodes", "reliefs", "good", "units")
_OPTIONAL_ARRAY = "anisotropies"
# what numpy and zipfile raise for files that are damaged, or no archives
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


@contextmanager
def law_file_errors(path: str | Path, part: str, remedy: str) -> Iterator[None]:
    """Within the block, errors of reading a file become those of a law.

    Parameters
    ----------
    part : of the file that holds a design or a material.
    remedy : how to make the file again.

    Raises
    ------
    LawError
        The file is damaged, or its `part` cannot be read.
    UnreadableLaw
        The file is missing, or cannot be read.
    """
    try:
        yield
    except OSError as error:
        if error.filename is None:  # no error of the disk: the archive points to places outside of its file
            raise LawError(f"{path}: is not a law, or damaged") from None
        raise UnreadableLaw(f"{path}: cannot be read: {error.strerror or error}") from None
    except DesignError as error:
        raise LawError(f"{path}: its {part} cannot be read: {error}; {remedy}") from None
    except DAMAGED_FILE_ERRORS as error:
        if isinstance(error, LawError):
            raise
        raise LawError(f"{path}: is not a law, or damaged") from None


class PackedRows(Sequence[Any]):
    """A list as compressed JSON, unpacked at the first access: a preview does not use the samples of its law."""

    def __init__(self, packed: bytes, file: str | Path = "the law") -> None:
        self.packed, self.file = packed, file

    @classmethod
    def of(cls, rows: Sequence[Any]) -> PackedRows:
        """The packed rows; rows that are packed already, unchanged."""
        return rows if isinstance(rows, cls) else cls(zlib.compress(json.dumps(list(rows)).encode()))

    @cached_property
    def _rows(self) -> list[Any]:
        try:
            rows = json.loads(zlib.decompress(self.packed))
        except (zlib.error, ValueError):
            raise LawError(f"{self.file}: its cells are damaged; {_REMEDY}") from None
        return rows if isinstance(rows, list) else []

    def __len__(self) -> int:
        return len(self._rows)

    def __getitem__(self, number: Any) -> Any:
        return self._rows[number]


def law_bytes(law: Law) -> bytes:
    """The content of the law's file. Equal laws give equal bytes."""
    texts: dict[str, Any] = {
        "material": law.material.to_dict(),
        "residuals": law.residuals,
        "made": law.made,
    }
    arrays: dict[str, Any] = {"format": np.array(LAW_FORMAT), "names": np.array(QUANTITY_NAMES)}
    arrays |= {name: np.frombuffer(json.dumps(text).encode(), np.uint8) for name, text in texts.items()}
    arrays["samples"] = np.frombuffer(PackedRows.of(law.samples).packed, np.uint8)
    for number, table in enumerate(law.tables):
        arrays |= {f"{number}/{name}": array for name, array in _table_arrays(table).items()}
    stream = io.BytesIO()
    np.savez_compressed(stream, allow_pickle=False, **arrays)
    return stream.getvalue()


def law_digest(law: Law) -> str:
    """Hash of tables, material, samples and residuals. It does not depend on where and when the law was computed.

    Examples
    --------
    >>> law_digest(load_law())
    '1a7ca71c37965386'
    """
    parts = [json.dumps([law.material.to_dict(), list(law.samples), law.residuals], sort_keys=True).encode()]
    parts += [array.tobytes() for table in law.tables for array in _table_arrays(table).values()]
    return hashlib.sha256(b"".join(parts)).hexdigest()[:16]


def load_law(path: str | Path | None = None) -> Law:
    """A law from its file; by default the law of the paper's material, which comes with the package.

    Raises
    ------
    LawError
        The file is damaged, is not a law, or has another format; one line.
    UnreadableLaw
        The file is missing, or cannot be read.

    Examples
    --------
    >>> law = load_law()
    >>> law.material.name, law.stretches, law.edge_mm
    ('paper', (1.35, 1.75), 1.15)
    >>> kappa = law.at(1.35)(9.0, 0.42, 1.2).value["kappa"]  # 1/mm, of stars of 9.0 x 0.42 x 1.2 mm
    >>> kappa.round(4)
    array([0.0258])
    """
    path = PAPER_LAW if path is None else Path(path)
    with law_file_errors(path, "material", _REMEDY):
        check_regular(path)
        with np.load(path, allow_pickle=False) as archive:
            if KIND in archive:
                raise LawError(f"{path}: is the law of a motif, not of stars")
            if "format" not in archive:
                raise LawError(f"{path}: is not a law")
            if (version := int(archive["format"])) != LAW_FORMAT:
                raise LawError(f"{path}: has format {version}, this version reads {LAW_FORMAT}; {_REMEDY}")
            if tuple(archive["names"]) != QUANTITY_NAMES:
                raise LawError(f"{path}: holds other quantities than this version; {_REMEDY}")
            samples = PackedRows(archive["samples"].tobytes(), path)
            material, residuals, made = (json.loads(archive[name].tobytes()) for name in _TEXTS)
            if not (isinstance(residuals, dict) and isinstance(made, dict)):
                raise ValueError("residuals or origin are not tables")
            tables = _tables(archive)
        law = Law(Material.from_dict(material), tables, samples, residuals, made)
        _check_whole(law)
        columns = anisotropy_size(law.material.lattice)
        if any(table.anisotropies.shape[-1] != columns for table in law.tables):
            raise LawError(f"{path}: lacks the differences between directions; {_REMEDY}")
        if columns and not all("tubes" in kinds for kinds in residuals.values()):
            raise LawError(f"{path}: lacks the number of stable cells; {_REMEDY}")
        if columns and not all("symmetry" in kinds for kinds in residuals.values()):
            raise LawError(f"{path}: its cells lack the symmetry of star and lattice; {_REMEDY}")
        return law


def _check_whole(law: Law) -> None:
    """Raise ValueError if the parts of a law do not belong together."""
    stretches = tuple(table.stretch for table in law.tables)
    has_errors = all("errors" in kinds["held_out"] for kinds in law.residuals.values())
    waves = len(CorrugationWaves.of(law.material.lattice))
    fits = all(table.corrugations.shape[-1] == waves for table in law.tables)
    if stretches != law.material.stretches or not has_errors or not fits:
        raise ValueError("tables, residuals and material belong to different laws")


def _tables(archive: Mapping[str, Any]) -> tuple[LawTable, ...]:
    """The tables of a file, whose arrays have names that begin with a number. Other arrays are ignored."""
    count = len({name.split("/")[0] for name in archive if "/" in name and name[0].isdigit()})
    return tuple(_table(_arrays_of(archive, f"{number}/")) for number in range(count))


def _arrays_of(archive: Mapping[str, Any], begin: str) -> dict[str, np.ndarray]:
    """The arrays of a table in a file, by their names without the beginning."""
    names = [*_ARRAYS, *([_OPTIONAL_ARRAY] if f"{begin}{_OPTIONAL_ARRAY}" in archive else [])]
    return {name: archive[f"{begin}{name}"] for name in names}


def _table_arrays(table: LawTable) -> dict[str, np.ndarray]:
    numbers = (np.array(table.stretch), np.array(table.spacing_mm))
    values = (*numbers, *table.axis_nodes, table.node_values, table.corrugations, table.solved, table.units)
    arrays = dict(zip(_ARRAYS, values, strict=True))
    return arrays | ({_OPTIONAL_ARRAY: table.anisotropies} if table.anisotropies.size else {})


def _table(arrays: dict[str, np.ndarray]) -> LawTable:
    """A table from its arrays; ValueError if they do not fit together, or hold impossible numbers."""
    axis_nodes = tuple(arrays[axis.key] for axis in AXES)
    shape = tuple(len(nodes) for nodes in axis_nodes)
    anisotropies = arrays.get(_OPTIONAL_ARRAY, np.empty((*shape, 0)))
    node_values, corrugations, solved, units = (arrays[name] for name in ("nodes", "reliefs", "good", "units"))
    fits = (
        node_values.shape == (*shape, len(QUANTITY_NAMES))
        and solved.shape == shape
        and solved.dtype == bool
        and corrugations.ndim == len(shape) + 2
        and corrugations.shape[:-1] == (*shape, 2)
        and anisotropies.shape[:-1] == shape
    )
    if not fits or not all(np.isfinite(array).all() for array in arrays.values()):
        raise ValueError("arrays do not fit together, or have gaps")
    for axis, nodes in zip(AXES, axis_nodes, strict=True):
        if not (np.diff(nodes) > 0).all() or nodes[0] < 0 or (axis.logarithmic and nodes[0] == 0):
            raise ValueError(f"{axis.key} must be positive and increase")
    stretch, spacing = float(arrays["stretch"]), float(arrays["spacing_mm"])
    with np.errstate(all="ignore"):  # the next line finds what is not finite
        stored = to_stored(node_values, units)
    if not (np.isfinite(stored).all() and stretch > 0 and spacing > 0):
        raise ValueError("quantities must be finite, stretch and spacing positive")
    return LawTable(stretch, spacing, axis_nodes, node_values, corrugations, solved, units, anisotropies)
