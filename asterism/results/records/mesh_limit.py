"""The limit of an infinitely fine mesh, by a preview."""

from __future__ import annotations

from asterism.results.record import Record, key


class MeshLimitRecord(Record):
    """The preview in the limit of an infinitely fine mesh, and how far the preview on finite meshes is from it."""

    height_mm: float = key(
        "Height in the limit: that of the preview on finite meshes, times the ratio of both previews.", unit="mm"
    )
    roll_radius_mm: float | None = key(
        "Radius in the limit, likewise; null unless both previews are rolled.", unit="mm"
    )
    distance_percent: float = key(
        "Rms distance of both previews as a verification measures it, in percent of the diameter.", unit="%"
    )
    wall_s: float = key("Time that it took: of one preview and a comparison, or of three for some rolls.", unit="s")

    def in_words(self) -> str:
        """The row in the table on the terminal."""
        radius = "" if self.roll_radius_mm is None else f", radius {self.roll_radius_mm:.1f} mm"
        return f"height {self.height_mm:.1f} mm{radius}; {self.distance_percent:.2f} % of the diameter away"


def limit_in_words(record: Record) -> str | None:
    """The row of a record that may have the key `mesh_limit`; None without a limit."""
    limit: MeshLimitRecord | None = getattr(record, "mesh_limit", None)
    return None if limit is None else limit.in_words()
