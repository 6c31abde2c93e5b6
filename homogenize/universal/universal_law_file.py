"""The file of the universal law: its cells, its interpolation and its origin, in a numpy archive without pickles."""

from __future__ import annotations

import io
import json
from pathlib import Path

import numpy as np

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law_file import DAMAGED_FILE_ERRORS
from asterism.homogenize.law.law_table import QUANTITY_NAMES
from asterism.homogenize.universal.groups import GROUP_KEYS, GROUPS
from asterism.homogenize.universal.kriging import Covariance, Kriging
from asterism.homogenize.universal.solved_cells import ROW_NAMES, SolvedCells
from asterism.homogenize.universal.universal_law import UniversalLaw, kernel_factors, kriging_places
from asterism.pattern.design.files import check_regular

# raise it when arrays or groups change their meaning
UNIVERSAL_LAW_FORMAT = 2
PACKAGED_UNIVERSAL_LAW = Path(__file__).parents[1] / "data" / "universal.npz"


def universal_law_bytes(law: UniversalLaw) -> bytes:
    """The content of the file. Equal laws give equal bytes."""
    reasons = sorted(set(law.cells.problems))
    limits = [group.limits for group in GROUPS]
    arrays = {
        "universal_format": np.array(UNIVERSAL_LAW_FORMAT),
        "groups": np.array(GROUP_KEYS),
        "limits": np.array(limits),
        "names": np.array(ROW_NAMES),
        "parts": np.array(list(law.parts)),
        "cell_groups": law.cells.groups,
        "cell_rows": law.cells.rows,
        "reasons": np.frombuffer(json.dumps(reasons).encode(), np.uint8),
        "cell_problems": np.array([reasons.index(problem) for problem in law.cells.problems], dtype=np.int16),
        "cell_seconds": law.cells.seconds.astype(np.float32),
        "left_out": law.left_out,
        "spread_count": np.array(law.spread_count),
        "made": np.frombuffer(json.dumps(law.made).encode(), np.uint8),
    }
    for name, part in law.parts.items():
        covariance = part.covariance
        arrays |= {f"{name}/lengths": covariance.lengths, f"{name}/noise": np.array(covariance.noise)}
        arrays |= {f"{name}/noise_slopes": covariance.noise_slopes, f"{name}/weights": part.weights}
    stream = io.BytesIO()
    np.savez_compressed(stream, allow_pickle=False, **arrays)
    return stream.getvalue()


def load_universal_law(path: Path = PACKAGED_UNIVERSAL_LAW) -> UniversalLaw:
    """The universal law from its file; by default the one that comes with the package.

    Raises
    ------
    LawError
        The file is damaged, is no universal law, or has another format; one line.
    """
    try:
        check_regular(path)
        with np.load(path, allow_pickle=False) as archive:
            if "universal_format" not in archive:
                raise LawError(f"{path}: is not a universal law")
            if int(archive["universal_format"]) != UNIVERSAL_LAW_FORMAT:
                raise LawError(f"{path}: has another format than this version; make it again: asterism law universal")
            limits = np.array([group.limits for group in GROUPS])
            same = tuple(archive["groups"]) == GROUP_KEYS and np.array_equal(archive["limits"], limits)
            if not same or tuple(archive["names"]) != ROW_NAMES:
                raise LawError(f"{path}: has other groups or quantities than this version; make it again")
            reasons = json.loads(archive["reasons"].tobytes())
            problems = tuple(reasons[number] for number in archive["cell_problems"])
            groups, rows = archive["cell_groups"], archive["cell_rows"]
            cells = SolvedCells(groups, rows, problems, archive["cell_seconds"].astype(float))
            usable = groups[cells.usable]
            places = kriging_places(usable)
            parts = {}
            for name in archive["parts"].tolist():
                own = (archive[f"{name}/{key}"] for key in ("lengths", "noise", "noise_slopes", "weights"))
                lengths, noise, slopes, weights = own
                if lengths.shape != (len(GROUPS),) or len(weights) != len(places) or not np.isfinite(weights).all():
                    raise ValueError("weights and cells do not fit together")
                covariance = Covariance(lengths, float(noise), slopes)
                parts[name] = Kriging(places, kernel_factors(name, usable), covariance, weights)
            left_out, made = archive["left_out"], json.loads(archive["made"].tobytes())
            if left_out.shape != (len(places), len(QUANTITY_NAMES)):
                raise ValueError("errors and cells do not fit together")
            return UniversalLaw(cells, parts, left_out, int(archive["spread_count"]), made)
    except OSError as error:
        raise LawError(f"{path}: cannot be read: {error.strerror or error}") from None
    except DAMAGED_FILE_ERRORS as error:
        if isinstance(error, LawError):
            raise
        raise LawError(f"{path}: is not a universal law, or damaged") from None
