"""The widget: traits that a notebook keeps equal in Python and on the page. Importing this module needs anywidget."""

from __future__ import annotations

from typing import Any

import anywidget
import traitlets

from asterism.notebook.live_sheet import LiveSheet, Traits
from asterism.notebook.module_text import widget_module


class SheetWidget(anywidget.AnyWidget):
    """A sheet in space, as `asterism.show` returns it.

    Parameters
    ----------
    traits : what is shown at first.
    live : answers the sliders; None for a shape.

    Attributes
    ----------
    mesh, frame : what is drawn, as binary frames of the studio.
    panel : sliders, figures, warnings and problem.
    request : the last request of the sliders; the page sets it.
    height_px : height of the picture.
    """

    _esm = widget_module()
    mesh = traitlets.Bytes().tag(sync=True)
    frame = traitlets.Bytes().tag(sync=True)
    panel = traitlets.Dict().tag(sync=True)
    request = traitlets.Dict().tag(sync=True)
    height_px = traitlets.Int().tag(sync=True)

    def __init__(self, traits: Traits, height_px: int, live: LiveSheet | None = None) -> None:
        super().__init__(height_px=height_px, **traits)
        self._live = live
        self.observe(self._asked, "request")

    def _asked(self, change: Any) -> None:
        """Answer a request of the page, stage by stage."""
        if self._live is None:
            return
        for traits in self._live.answer(change["new"]):
            with self.hold_sync():  # a shape arrives together with its mesh
                self.set_trait("mesh", traits.get("mesh", self.mesh))
                self.set_trait("frame", traits.get("frame", self.frame))
                self.set_trait("panel", traits.get("panel", self.panel))
