"""The file of a law: arrays and texts in a numpy archive, without pickles.

It holds the tables and everything that produced them: the plan with the design of its cell and the mesh edge, versions
and command, all samples, and the residuals.
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
from typing import Any, overload

import numpy as np

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.errors import LawError, UnreadableLaw
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.motif_law import MotifLaw, MotifTable
from asterism.homogenize.law.plan import LawPlan
from asterism.homogenize.law.star_law import StarLaw, StarTable
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.files import read_bytes

# raise it when the arrays or quantities of a file change their meaning
LAW_FORMAT = 5
PAPER_LAW = Path(__file__).parents[1] / "data" / "paper.npz"
_REMEDY = "make it again: asterism calibrate"


def law_of_tables(
    plan: LawPlan,
    tables: Sequence[tuple[Floats, Bools]],
    samples: Sequence[dict[str, Any]],
    residuals: dict[str, Any],
    made: dict[str, Any],
) -> StarLaw | MotifLaw:
    """The law from the stored forms and solved nodes of its tables, in the order of the plan's stretches."""
    pairs = list(zip(plan.stretches, tables, strict=True))
    if plan.is_motif:
        motifs = tuple(MotifTable(plan, stretch, *arrays) for stretch, arrays in pairs)
        return MotifLaw(plan, motifs, samples, residuals, made)
    stars = tuple(StarTable(plan, stretch, *arrays) for stretch, arrays in pairs)
    return StarLaw(plan, stars, samples, residuals, made)


@contextmanager
def _file_errors(path: Path) -> Iterator[None]:
    """Within the block, errors of reading a file become those of a law."""
    try:
        yield
    except OSError as error:
        if error.filename is None:  # no error of the disk: the archive points to places outside of its file
            raise LawError(f"{path}: is not a law, or damaged") from None
        raise UnreadableLaw(f"{path}: cannot be read: {error.strerror or error}") from None
    except DesignError as error:
        raise LawError(f"{path}: its plan cannot be read: {error}; {_REMEDY}") from None
    except LawError:
        raise
    # what numpy and zipfile raise for files that are damaged, or no archives
    except (
        KeyError,
        TypeError,
        ValueError,
        EOFError,
        RuntimeError,
        tokenize.TokenError,
        zipfile.BadZipFile,
        zlib.error,
    ):
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


def law_bytes(law: Law[Any]) -> bytes:
    """The content of the law's file. Equal laws give equal bytes."""
    texts: dict[str, Any] = {"plan": law.plan.to_dict(), "residuals": law.residuals, "made": law.made}
    arrays: dict[str, Any] = {"format": np.array(LAW_FORMAT)}
    arrays |= {name: np.frombuffer(json.dumps(text).encode(), np.uint8) for name, text in texts.items()}
    arrays["samples"] = np.frombuffer(PackedRows.of(law.samples).packed, np.uint8)
    for number, table in enumerate(law.tables):
        arrays |= {f"{number}/stored": table.stored, f"{number}/solved": table.solved}
    stream = io.BytesIO()
    np.savez_compressed(stream, allow_pickle=False, **arrays)
    return stream.getvalue()


def law_digest(law: Law[Any]) -> str:
    """Hash of tables, plan, samples and residuals. It does not depend on where and when the law was computed.

    >>> law_digest(load_law())
    '43778279211aedb9'
    """
    parts = [json.dumps([law.plan.to_dict(), list(law.samples), law.residuals], sort_keys=True).encode()]
    parts += [array.tobytes() for table in law.tables for array in (table.stored, table.solved)]
    return hashlib.sha256(b"".join(parts)).hexdigest()[:16]


@overload
def load_law(path: None = None) -> StarLaw: ...
@overload
def load_law(path: str | Path) -> StarLaw | MotifLaw: ...
def load_law(path: str | Path | None = None) -> StarLaw | MotifLaw:
    """A law from its file, of stars or of a motif; by default the law of the paper's material, which comes with the
    package.

    Raises
    ------
    LawError
        The file is damaged, is not a law, or has another format; one line.
    UnreadableLaw
        The file is missing, or cannot be read.

    Examples
    --------
    >>> law = load_law()
    >>> law.plan.design.name, law.stretches, law.edge_mm
    ('paper', (1.35, 1.75), 1.0189)
    >>> kappa = law.at(1.35)(9.0, 0.42, 1.2).value["kappa"]  # 1/mm, of stars of 9.0 x 0.42 x 1.2 mm
    >>> kappa.round(4)
    array([0.0248])
    """
    path = PAPER_LAW if path is None else Path(path)
    with _file_errors(path):
        with np.load(io.BytesIO(read_bytes(path, 1_000_000_000)), allow_pickle=False) as archive:
            if "format" not in archive:
                raise LawError(f"{path}: is not a law")
            if (version := int(archive["format"])) != LAW_FORMAT:
                raise LawError(f"{path}: has format {version}, this version reads {LAW_FORMAT}; {_REMEDY}")
            data, residuals, made = (json.loads(archive[name].tobytes()) for name in ("plan", "residuals", "made"))
            plan = LawPlan.from_dict(data)
            keys = [each["key"] for each in data["sizes"]]
            tables = [_table(plan, keys, archive, number) for number in range(len(plan.stretches))]
            samples = PackedRows(archive["samples"].tobytes(), path)
        if not (isinstance(made, dict) and all("errors" in each["held_out"] for each in residuals.values())):
            raise ValueError("residuals or origin are not tables")
        return law_of_tables(plan, tables, samples, residuals, made)


def _table(plan: LawPlan, keys: Sequence[str], archive: Mapping[str, Any], number: int) -> tuple[Floats, Bools]:
    """The arrays of a table with axes of these sizes; ValueError if they do not fit the plan, or have gaps."""
    stored, solved = (archive[f"{number}/{name}"] for name in ("stored", "solved"))
    shape = tuple(len(nodes) for nodes in plan.axis_nodes)
    columns = (MotifTable if plan.is_motif else StarTable).columns(plan)
    # a law that was made before a size was known has no axis for it
    given = tuple(count for size, count in zip(plan.sizes, shape, strict=True) if size.key in keys)
    if stored.shape != (*given, columns) or solved.shape != given or solved.dtype != bool:
        raise ValueError("arrays do not fit together")
    if not np.isfinite(stored).all():
        raise ValueError("quantities must be finite")
    return stored.reshape(*shape, columns), solved.reshape(shape)
