"""The change of a document that a gesture of a page asks for."""

from __future__ import annotations

from typing import Any

from asterism.studio.document import Document
from asterism.studio.drawing import Drawings
from asterism.studio.gesture_requests import (
    BrushRequest,
    Change,
    GestureRequest,
    Paint,
    PlaceDrawing,
    StarsRequest,
    Weigh,
)
from asterism.studio.placed_drawing import with_drawing


def apply_gesture(request: GestureRequest, document: Document, gesture: Any, drawings: Drawings) -> str | None:
    """Change the document; all requests of one gesture are one step of undo. A note for all pages, if there is one.

    Raises
    ------
    Error
        The change is refused; the document stays as it is.
    """
    match request:
        case Change():
            document.change(request.changes, gesture)
        case Paint():
            document.paint(request.sites, request.sizes, gesture)
        case BrushRequest():
            document.brush(request.size, request.brush, request.places, gesture)
        case PlaceDrawing():
            drawing = drawings.get(request.drawing)
            table, note = with_drawing(document.table, drawing, request, document.layout.outline)
            document.apply(table, gesture, drawing.name[:60])
            return note
        case Weigh():
            document.weigh(request.sites, request.weights, gesture)
        case StarsRequest():
            change = {"remove": document.remove, "restore": document.restore, "reset": document.reset}
            change[request.type](request.sites, gesture)
    return None
