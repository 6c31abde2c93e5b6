"""The inputs of a verification besides the design: command, law, meshes and version."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def origins(summary: Mapping[str, Any]) -> list[list[str]]:
    """Rows of a table, from the summary of a verification. The law is missing if another shape replaced the preview."""
    preview, exact = summary["preview"], summary["exact"]
    rows = [["command", summary["command"]]] if summary["command"] else []
    if law := preview.get("law"):
        made = f", made by {law['made_by']}" if law["made_by"] else ""
        what = f"{law['material']}, fabric stretched {law['stretch']:g}, edges of {law['edge_mm']:g} mm{made}"
        rows.append(["law", what])
    if "shell_triangles" in preview:
        rows.append(["preview", f"{preview['shell_triangles']} triangles, side {preview['side']}"])
    mesh = f"edges of {exact['edge_mm']:g} mm, {exact['triangles']} triangles ({exact['mesh']} mesh)"
    rows.append(["exact model", f"{mesh}, fabric bending {exact['fabric_bending']}, solver {exact['backend']}"])
    return [*rows, ["asterism", summary["version"]]]
