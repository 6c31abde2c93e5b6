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

from asterism.studio.messages import Frame

MESH, SHAPE, KEPT, TARGET = 1, 2, 3, 4


def pack(kind: int, header: Mapping[str, Any], arrays: Mapping[str, Any]) -> bytes:
    """One frame.

    Parameters
    ----------
    arrays : floats are sent as 4 bytes, whole numbers as unsigned 4 bytes, uint8 as they are; of unit vectors, whose
        name ends with `normals`, as int8 up to 127.

    Examples
    --------
    >>> frame = pack(MESH, {"mesh": 3}, {"printed": [[1.0, 2.0]]})
    >>> kind, length = struct.unpack_from("<II", frame)
    >>> kind, json.loads(frame[8 : 8 + length])["mesh"], np.frombuffer(frame[8 + length :], "<f4").tolist()
    (1, 3, [1.0, 2.0])
    """
    blocks = {name: _block(name, values) for name, values in arrays.items()}
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


def _block(name: str, values: Any) -> Any:
    array = np.asarray(values)
    if name.endswith("normals"):
        array = np.rint(127.0 * array).astype(np.int8)
    kept = array.dtype.itemsize == 1 and array.dtype.kind in "iu"
    dtype = {"f": "<f4", "u": "<u4", "i": "<u4", "b": "<u1"}[array.dtype.kind]
    return np.ascontiguousarray(array if kept else array.astype(dtype))


def mesh_bytes(frame: Frame) -> bytes:
    """The binary frame of the mesh of a shape."""
    return pack(MESH, {"mesh": frame.mesh}, frame.mesh_arrays)
