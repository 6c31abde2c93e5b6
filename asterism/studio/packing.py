"""Meshes and shapes as the page takes them: binary frames, normals as whole numbers up to 127."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Array
from asterism.studio import frames
from asterism.studio.messages import Frame, ShownMesh


def mesh_bytes(mesh: ShownMesh) -> bytes:
    """The binary frame of a mesh."""
    arrays = {
        "printed": mesh.printed,
        "triangles": mesh.triangles,
        "outline": mesh.outline,
        "arm_site": mesh.arm_site,
    }
    return frames.pack(frames.MESH, {"mesh": mesh.mesh, "is_fine": mesh.is_fine}, arrays)


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
    if (smooth := frame.smooth) is not None:
        arrays |= {
            "smooth": smooth.positions,
            "smooth_arms": smooth.arms,
            "smooth_arm_normals": _whole(smooth.arm_normals),
            "smooth_needles": smooth.needles,
        }
    if (target := frame.target) is not None:
        arrays["target"] = target.distance
        header["target"] = {"rms_mm": target.rms_mm, "max_mm": target.max_mm, "version": target.version}
    return header, arrays


def _whole(normals: Array) -> Array:
    """Unit vectors as whole numbers up to 127."""
    return np.rint(127.0 * np.asarray(normals)).astype(np.int8)
