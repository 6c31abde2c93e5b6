"""`asterism.show`: a shape in a notebook, or a preview behind sliders.

All but `show` is independent of notebooks: requests of the page go in, meshes, shapes and texts come out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import Error
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.design import Design
from asterism.pattern.design.pins import Pins
from asterism.pattern.design.section import is_whole
from asterism.pattern.design.stars import SIZE_KEYS, STAR_SIZES
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.painted_stars import with_painted_stars
from asterism.previews.session import Preview
from asterism.previews.solve import EDIT_START
from asterism.shape.shape import Shape
from asterism.studio import frames
from asterism.studio.answers import engine_problem
from asterism.studio.engine_frames import SheetView
from asterism.studio.messages import Frame
from asterism.studio.sheet_frames import shape_frame

if TYPE_CHECKING:
    from asterism.notebook.widget import SheetWidget

HEIGHT_RANGE_PX = (120, 4000)


class NotebookError(Error):
    """The notebook lacks what a widget needs."""


def show(shown: Shape | Preview, sliders: Sequence[str] | None = None, height_px: int = 420) -> SheetWidget:
    """Show a sheet in a notebook: drag to turn it, click into it and use the wheel to zoom.

    A preview gets sliders. They change the preview in place, by `Preview.edit`: `preview.design` is the design that the
    page shows. While a slider moves, the newest value is computed, and values that it has passed are left out.

    Parameters
    ----------
    shown : a shape of either model, or a `Preview`.
    sliders : for a preview, some of the following; by default all that its design has. `length`, `thickness` and
        `width` multiply these sizes of all stars, within the range of the law. `stretch` chooses among the stretches of
        the law. `needle_scale` multiplies the distances of all pins from the origin, `needle_height` their heights.
    height_px : height of the picture, from 120 to 4000 pixels.

    Returns
    -------
    The widget. A notebook shows it if it is the last value of a cell.

    Raises
    ------
    NotebookError
        The package anywidget is missing; the extra `notebook` installs it.
    TypeError
        `shown` is neither a shape nor a preview.
    ValueError
        A slider or the height is not one of those above, the design lacks what a slider changes, or sliders are given
        for a shape.

    Examples
    --------
    >>> from asterism.pattern import gallery
    >>> widget = show(Preview(gallery.load("dome")), sliders=["thickness", "needle_scale"])
    >>> [slider["label"] for slider in widget.panel["sliders"]]
    ['Thickness', 'Distances of the needles']
    """
    if not isinstance(shown, Shape | Preview):
        raise TypeError(
            f"a Shape or a Preview is needed, not {type(shown).__name__}: preview, simulate and Preview make them"
        )
    if not (is_whole(height_px) and HEIGHT_RANGE_PX[0] <= height_px <= HEIGHT_RANGE_PX[1]):
        raise ValueError(
            f"height_px = {height_px!r}: must be a whole number from {HEIGHT_RANGE_PX[0]} to {HEIGHT_RANGE_PX[1]}"
        )
    if isinstance(sliders, str):
        raise ValueError(f"sliders = {sliders!r}: must be a list of names")
    if isinstance(shown, Shape) and sliders:
        raise ValueError("sliders belong to a Preview: a Shape does not change")
    try:
        from asterism.notebook.widget import SheetWidget
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] == "asterism":
            raise
        raise NotebookError(
            f"asterism.show needs the package {error.name}, which the extra notebook installs: pip install anywidget"
        ) from None
    if isinstance(shown, Shape):
        return SheetWidget(shape_traits(shown), height_px)
    live = LiveSheet(shown, sliders)
    return SheetWidget(live.opening(), height_px, live.answer)


SIZE_SLIDERS = {size.name: size.name.capitalize() for size in STAR_SIZES}
SLIDERS = (*SIZE_SLIDERS, "stretch", "needle_scale", "needle_height")
# Values of the widget's traits that change together: `mesh` and `frame` as bytes, `panel` as a table.
Traits = dict[str, Any]


class LiveSheet:
    """Changes a preview in place as the sliders ask; `keys` as of `SliderBoard`."""

    def __init__(self, preview: Preview, keys: Sequence[str] | None = None) -> None:
        self.preview = preview
        self._board = SliderBoard(preview.design, preview.sheet.layout, preview.law, keys)
        self._values = self._board.start
        self._views: dict[bool, SheetView] = {}  # by whether the mesh is fine
        self._rotation: Floats | None = None  # of a free sheet, from the pose of the shell to the shown one
        self._panel = panel(preview.design.name, sliders=[asdict(slider) for slider in self._board.sliders])

    def opening(self) -> Traits:
        """What the widget shows at first."""
        return self._drawn(False, "equilibrium", None) | self._at_rest() | self._told()

    def answer(self, request: Mapping[str, Any]) -> Iterator[Traits]:
        """The answers to a request, as they come; the last one carries its number in `panel["answered"]`.

        `request`: `seq`, its number; `values` by the keys of the sliders; `is_dragging`, whether more will follow. The
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
        preview = self.preview
        view = self._views.get(is_fine)
        if view is None or not view.shows(preview):
            view = self._views[is_fine] = SheetView(preview, is_fine)
        is_new_form = stage == "equilibrium" and preview.equilibrium.guess != EDIT_START
        if self._rotation is None or (is_new_form and not is_fine):
            view.stand_up(preview, x)
            self._rotation = view.rotation
        view.rotation = self._rotation
        frame = view.frame(preview, 0, stage, x)
        self._height_mm = frame.height_mm
        return {"mesh": frames.mesh_bytes(frame), "frame": shape_bytes(frame)}


def shape_traits(shape: Shape) -> Traits:
    """What the widget shows of a shape of either model."""
    frame = shape_frame(shape)
    name, warnings = shape.summary.get("design", {}).get("name", ""), list(shape.summary.get("warnings", ()))
    known = panel(name, figures=shape_figures(shape), warnings=warnings)
    return {"mesh": frames.mesh_bytes(frame), "frame": shape_bytes(frame), "panel": known}


def shape_bytes(frame: Frame) -> bytes:
    """The binary frame of a shape."""
    return frames.pack(frames.SHAPE, {"mesh": frame.mesh, "frame": frame.seq, **frame.header}, frame.arrays)


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


@dataclass(frozen=True)
class Slider:
    """A value of a design that a slider changes.

    Attributes
    ----------
    key : one of `SLIDERS`.
    label : name on the page.
    low, high, step, start : of the slider's value; a factor, but for the stretch.
    base : smallest and largest size at the factor 1; None if the value itself is shown.
    unit, digits : of the size, or of the value.
    options : the values that are possible, if only some are.
    """

    key: str
    label: str
    low: float
    high: float
    step: float
    start: float = 1.0
    base: tuple[float, float] | None = None
    unit: str = "mm"
    digits: int = 1
    options: tuple[float, ...] = ()


class SliderBoard:
    """The sliders of the design of a preview when it is shown, in the order of `keys`; by default all that it has.

    Raises ValueError: a key is no slider, or the design does not have it.
    """

    def __init__(self, design: Design, layout: Layout, law: StarLaw, keys: Sequence[str] | None = None) -> None:
        self._design, self._layout = design, layout
        sizes = layout.site_sizes_mm
        self._is_star = sizes[:, 0] > 0
        present = {slider.key: slider for slider in self._present(law)}
        chosen = list(present) if keys is None else list(keys)
        for key in chosen:
            if key not in SLIDERS:
                raise ValueError(f"sliders: {key!r} must be one of {', '.join(SLIDERS)}")
            if key not in present:
                raise ValueError(f"sliders: this design has no {key!r}, but {', '.join(present) or 'none'}")
        self.sliders = [present[key] for key in dict.fromkeys(chosen)]

    @property
    def start(self) -> dict[str, float]:
        """The values of the design itself."""
        return {slider.key: slider.start for slider in self.sliders}

    def checked(self, values: Mapping[str, Any]) -> dict[str, float]:
        """Values within the ranges of the sliders; those that are left out are the design's own.

        Raises ValueError: there is no such slider, or a value is no number.
        """
        out = self.start
        by_key = {slider.key: slider for slider in self.sliders}
        for key, value in values.items():
            if key not in by_key:
                raise ValueError(f"{key!r} is no slider of this sheet")
            if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
                raise ValueError(f"{key} = {value!r}: must be a number")
            slider = by_key[key]
            if slider.options:
                out[key] = min(slider.options, key=lambda option: abs(option - value))
            else:
                out[key] = float(min(max(value, slider.low), slider.high))
        return out

    def design_at(self, values: Mapping[str, Any]) -> Design:
        """The design at values of the sliders; raises the errors of `checked` and of `Design.from_dict`."""
        checked = self.checked(values)
        if checked == self.start:
            return self._design
        design = self._with_sizes([checked.get(key, 1.0) for key in SIZE_SLIDERS])
        if "stretch" in checked and checked["stretch"] != design.fabric.stretch:
            fabric = design.fabric.model_copy(update={"stretch": checked["stretch"]})
            design = design.model_copy(update={"fabric": fabric})
        place, height = checked.get("needle_scale", 1.0), checked.get("needle_height", 1.0)
        return design.model_copy(update={"pins": tuple(_moved(pins, place, height) for pins in design.pins)})

    def _present(self, law: StarLaw) -> list[Slider]:
        """All sliders that the design has."""
        design, out = self._design, []
        ranges = law.size_ranges(design.fabric.stretch_xy)
        for column, (key, label) in enumerate(SIZE_SLIDERS.items()):
            sizes = self._layout.site_sizes_mm[self._is_star, column]
            slider = _size_slider(key, label, sizes, ranges[SIZE_KEYS[column]])
            if slider is not None:
                out.append(slider)
        stretch = design.fabric.stretch
        options = law.even_stretches
        if stretch in options and len(options) > 1:
            shown: dict[str, Any] = {"start": float(stretch), "unit": "", "digits": 2, "options": options}
            out.append(Slider("stretch", "Stretch of the fabric", options[0], options[-1], 0.01, **shown))
        if design.pins:
            label = "Distances of the needles"
            out.append(Slider("needle_scale", label, 0.8, 1.2, 0.005, unit="×", digits=3))
        heights = [height for pins in design.pins for height in _heights(pins) if height != 0]
        if heights:
            base = (min(heights), max(heights))
            out.append(Slider("needle_height", "Heights of the needles", 0.0, 2.0, 0.02, base=base))
        return out

    def _with_sizes(self, factors: Sequence[float]) -> Design:
        """The design with the sizes of all its stars times factors of length, thickness and width."""
        design = self._design
        changed = np.array([factor != 1.0 for factor in factors])
        if not changed.any():
            return design
        # mm, of sizes that a factor gives
        sizes: Floats = np.round(self._layout.site_sizes_mm * np.asarray(factors), 4)
        stars, columns = design.required_stars, np.flatnonzero(changed)
        if not stars.override and all(isinstance(getattr(stars, SIZE_KEYS[k]), int | float) for k in columns):
            star = int(np.flatnonzero(self._is_star)[0])
            update: dict[str, float] = {SIZE_KEYS[k]: float(sizes[star, k]) for k in columns}
            return design.model_copy(update={"stars": stars.model_copy(update=update)})
        sizes[:, ~changed] = np.nan
        return with_painted_stars(design, self._layout.sheet_sites[self._is_star], sizes[self._is_star])


def _size_slider(key: str, label: str, sizes: Floats, covered: tuple[float, float]) -> Slider | None:
    """A factor of sizes (n,) mm that keeps them in the range that the law covers; None if only 1 does."""
    smallest, largest, step = float(sizes.min()), float(sizes.max()), 0.01
    low = min(1.0, max(0.5, covered[0] / smallest))
    high = max(1.0, min(1.5, covered[1] / largest))
    low, high = float(np.ceil(low / step - 1e-9)), float(np.floor(high / step + 1e-9))
    if low >= high:
        return None
    digits = 1 if key == "length" else 2
    low, high = (round(steps * step, 6) for steps in (low, high))
    return Slider(key, label, low, high, step, base=(smallest, largest), digits=digits)


def _heights(pins: Pins) -> list[float]:
    return [place[2] for place in pins.target_mm] if pins.target_mm is not None else [pins.offset_mm[2]]


def _moved(pins: Pins, place: float, height: float) -> Pins:
    """Pins whose distances from the origin and whose heights are multiplied."""
    factor = np.array([place, place, height])
    if pins.target_mm is not None:
        targets = tuple(tuple(float(value) for value in row * factor) for row in np.asarray(pins.target_mm))
        return pins.model_copy(update={"target_mm": targets})
    offset = tuple(float(value) for value in np.asarray(pins.offset_mm) * factor)
    return pins.model_copy(update={"scale": pins.scale * place, "offset_mm": offset})
