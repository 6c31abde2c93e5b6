"""Binary frames for the page: a header in JSON and arrays behind it, little endian.

    u32 kind, u32 length of the header, the header padded with spaces to a multiple of 4, then the arrays

The header's `arrays` lists name, dtype (`f4`, `u4`, `i1`, `u1`), shape and offset of each array. Offsets are in bytes
from the start of the frame, and multiples of 4.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Array
from asterism.studio.messages import Frame, ShownMesh

MESH, SHAPE, KEPT = 1, 2, 3
_DTYPES = {"f": "f4", "u": "u4", "i": "u4", "b": "u1"}


def pack(kind: int, header: Mapping[str, Any], arrays: Mapping[str, Any]) -> bytes:
    """One frame.

    Parameters
    ----------
    arrays : floats are sent as 4 bytes, whole numbers as unsigned 4 bytes, int8 and uint8 as they are.

    Examples
    --------
    >>> kind, header, arrays = unpack(pack(MESH, {"mesh": 3}, {"printed": [[1.0, 2.0]]}))
    >>> kind, header["mesh"], arrays["printed"].tolist()
    (1, 3, [[1.0, 2.0]])
    """
    blocks = {name: _block(values) for name, values in arrays.items()}
    listed = [
        {"name": name, "dtype": values.dtype.str[1:], "shape": list(values.shape), "offset": 0}
        for name, values in blocks.items()
    ]
    # offsets have a fixed width, so that the header's length does not depend on them
    room = len(json.dumps({**header, "arrays": listed})) + 12 * len(listed)
    length = room + (-room) % 4
    offset = 8 + length
    for entry, values in zip(listed, blocks.values(), strict=True):
        entry["offset"] = offset
        offset += values.nbytes + (-values.nbytes) % 4
    text = json.dumps({**header, "arrays": listed}, allow_nan=False).encode("ascii").ljust(length)
    body = b"".join(values.tobytes() + b"\0" * ((-values.nbytes) % 4) for values in blocks.values())
    return struct.pack("<II", kind, length) + text + body


def unpack(frame: bytes) -> tuple[int, dict[str, Any], dict[str, Any]]:
    """Kind, header and arrays of a frame."""
    kind, length = struct.unpack_from("<II", frame)
    header = json.loads(frame[8 : 8 + length])
    arrays = {}
    for entry in header.pop("arrays"):
        count = int(np.prod(entry["shape"], dtype=np.int64))
        flat = np.frombuffer(frame, np.dtype("<" + entry["dtype"]), count, entry["offset"])
        arrays[entry["name"]] = flat.reshape(entry["shape"])
    return kind, header, arrays


def _block(values: Any) -> Any:
    array = np.asarray(values)
    kept = array.dtype.itemsize == 1 and array.dtype.kind in "iu"
    return np.ascontiguousarray(array if kept else array.astype("<" + _DTYPES[array.dtype.kind]))


def mesh_bytes(mesh: ShownMesh) -> bytes:
    """The binary frame of a mesh."""
    arrays = {
        "printed": mesh.printed,
        "triangles": mesh.triangles,
        "outline": mesh.outline,
        "arm_site": mesh.arm_site,
    }
    return pack(MESH, {"mesh": mesh.mesh}, arrays)


def frame_parts(frame: Frame) -> tuple[dict[str, Any], dict[str, Any]]:
    """Header and arrays of the binary frame of a shape."""
    header: dict[str, Any] = {
        "stage": frame.stage,
        "height_mm": float(frame.height_mm),
        "is_minimum": bool(frame.is_minimum),
        "seconds": frame.seconds,
    }
    arrays = {
        "positions": frame.positions,
        "curvature": frame.curvature,
        "strain": frame.strain,
        "arms": frame.arms,
        "arm_normals": _whole(frame.arm_normals),
        "needles": frame.needles,
    }
    for name, part in (("smooth", frame.smooth), ("before", frame.before)):
        if part is not None:
            arrays |= {
                name: part.positions,
                f"{name}_arms": part.arms,
                f"{name}_arm_normals": _whole(part.arm_normals),
                f"{name}_needles": part.needles,
            }
    if (target := frame.target) is not None:
        arrays["target"] = target.distance
        header["target"] = {"rms_mm": target.rms_mm, "max_mm": target.max_mm, "version": target.version}
    return header, arrays


def _whole(normals: Array) -> Array:
    """Unit vectors as whole numbers up to 127."""
    return np.rint(127.0 * np.asarray(normals)).astype(np.int8)
