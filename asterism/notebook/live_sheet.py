"""A preview behind sliders: requests of the page in, meshes, shapes and texts out; independent of notebooks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from asterism.equilibrium.arrays import Floats
from asterism.notebook.sliders import SliderBoard
from asterism.pattern.design.design import Design
from asterism.previews.session import Preview
from asterism.previews.solve import EDIT_START
from asterism.shape.shape import Shape
from asterism.studio import frames
from asterism.studio.answers import engine_problem
from asterism.studio.frames import frame_parts, mesh_bytes
from asterism.studio.messages import Frame
from asterism.studio.sheet_frames import shape_messages
from asterism.studio.sheet_view import SheetView

# Values of the widget's traits that change together: `mesh` and `frame` as bytes, `panel` as a table.
Traits = dict[str, Any]


class LiveSheet:
    """Changes a preview in place as the sliders ask; `keys` as of `SliderBoard`."""

    def __init__(self, preview: Preview, keys: Sequence[str] | None = None) -> None:
        self.preview = preview
        self._board = SliderBoard(preview.design, preview.sheet.layout, preview.law, keys)
        self._values = self._board.start
        self._views: dict[bool, SheetView] = {}  # by whether the mesh is fine
        self._packed_meshes: dict[bool, bytes] = {}
        self._rotation: Floats | None = None  # of a free sheet, from the pose of the shell to the shown one
        self._meshes = 0
        self._panel = panel(preview.design.name, sliders=[slider.data() for slider in self._board.sliders])

    def opening(self) -> Traits:
        """What the widget shows at first."""
        return self._drawn(False, "equilibrium", None) | self._at_rest() | self._told()

    def answer(self, request: Mapping[str, Any]) -> Iterator[Traits]:
        """The answers to a request, as they come; the last one carries its number in `panel["answered"]`.

        Parameters
        ----------
        request : `seq`, its number; `values` by the keys of the sliders; `is_dragging`, whether more will follow. The
            summary follows only if not.
        """
        seq = int(request["seq"])
        try:
            design = self._board.design_at(request["values"])
            self._values = self._board.checked(request["values"])
            self._panel["problem"] = None
            yield from self._edited(design)
            if not request.get("is_dragging"):
                yield self._at_rest()
        except Exception as error:
            self._panel["problem"] = engine_problem(seq, error).text
        finally:
            self._panel["answered"] = seq
        yield self._told()

    def _told(self) -> Traits:
        """The panel as a new table, so that the widget notices the change."""
        return {"panel": self._panel | {"values": dict(self._values)}}

    def _edited(self, design: Design) -> Iterator[Traits]:
        """The stages of an edit on the coarse mesh."""
        if design == self.preview.design and self.preview.equilibrium is self.preview.state.resting:
            return
        for stage in self.preview.edit(design):
            traits = self._drawn(False, stage.name, stage.x)
            self._panel |= {"figures": [["Height", f"{self._height_mm:.1f} mm"]], "warnings": []}
            yield traits | self._told()

    def _at_rest(self) -> Traits:
        """The shape on the fine mesh, and all that is known about it."""
        shape = self.preview.shape()
        self._panel |= {"figures": shape_figures(shape), "warnings": list(shape.summary["warnings"])}
        return self._drawn(True, "equilibrium", None)

    def _drawn(self, is_fine: bool, stage: str, x: Floats | None) -> Traits:
        """A stage with its mesh. The mesh stays the same over edits, unless other stars have arms."""
        preview, layout = self.preview, self.preview.sheet.layout
        view = self._views.get(is_fine)
        if view is None or not view.shows(preview):
            view = self._views[is_fine] = SheetView(preview, is_fine)
        if not view.has_arms_of(layout):
            self._meshes += 1
            self._packed_meshes[is_fine] = mesh_bytes(view.numbered(self._meshes, layout))
        is_new_form = stage == "equilibrium" and preview.equilibrium.guess != EDIT_START
        if self._rotation is None or (is_new_form and not is_fine):
            view.stand_up(preview, x)
            self._rotation = view.rotation
        view.rotation = self._rotation
        frame = view.frame(preview, 0, stage, x)
        self._height_mm = frame.height_mm
        return {"mesh": self._packed_meshes[is_fine], "frame": shape_bytes(frame)}


def shape_traits(shape: Shape) -> Traits:
    """What the widget shows of a shape of either model."""
    mesh, frame = shape_messages(shape)
    known = panel(
        shape.summary.get("name", ""), figures=shape_figures(shape), warnings=list(shape.summary.get("warnings", ()))
    )
    return {"mesh": mesh_bytes(mesh), "frame": shape_bytes(frame), "panel": known}


def shape_bytes(frame: Frame) -> bytes:
    """The binary frame of a shape."""
    header, arrays = frame_parts(frame)
    return frames.pack(frames.SHAPE, {"mesh": frame.mesh, "frame": frame.seq, **header}, arrays)


def panel(name: str, **known: Any) -> dict[str, Any]:
    """What stands beside the view: sliders, values, figures, warnings, a problem, the number of the last request."""
    empty: dict[str, Any] = {"sliders": [], "values": {}, "figures": [], "warnings": [], "problem": None, "answered": 0}
    return {"name": name, **empty, **known}


def shape_figures(shape: Shape) -> list[list[str]]:
    """Names and texts of the numbers of a shape."""
    summary = shape.summary
    out = [
        ["Height", f"{shape.extent_mm[2]:.1f} mm"],
        ["Size", " × ".join(f"{size:.0f}" for size in shape.extent_mm[:2]) + " mm"],
    ]
    expected = summary.get("expected_rms_percent")
    if expected is not None:
        out.append(["Estimated error", f"± {expected:.1f} % of the diameter"])
    out.append(["Computed", shape.made_by])
    if summary.get("is_minimum") is False:
        out.append(["Certificate", "not a minimum"])
    return out
