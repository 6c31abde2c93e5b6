"""The layers of the sheets: their names, colours and meanings."""

from __future__ import annotations

from asterism.print.drawing import DrawingLayer

FRAME = DrawingLayer("frame", "#6b6b6b", 0.5, meaning="frame")
OPENING = DrawingLayer("frame-opening", "#6b6b6b", 0.2, meaning="inside of the frame")
BED = DrawingLayer("printable-area", "#2f6fc1", 0.25, (4.0, 2.0), meaning="what the nozzle reaches")
STARS = DrawingLayer("stars", "#3a3a44", filled=True, meaning="stars")
RODS = DrawingLayer("rods", STARS.colour, filled=True, meaning="printed lines")
GUIDE = DrawingLayer("printed-border", "#8a8a94", filled=True, meaning="printed line to cut along")
CUT = DrawingLayer("cut", "#d01c1c", 0.25, meaning="cut here")
MARKS = DrawingLayer("alignment", "#0a7d32", 0.2, meaning="alignment marks")
BEFORE = DrawingLayer(
    "check-before-stretching", "#d98200", 0.25, (1.5, 1.5), meaning="square drawn on the relaxed fabric"
)
AFTER = DrawingLayer("check-after-stretching", "#d98200", 0.3, meaning="the same square on the stretched fabric")
NEEDLES = DrawingLayer("needles", "#a0109a", 0.3, meaning="needles")
OUTLINE_IN_SPACE = DrawingLayer(
    "outline", "#d01c1c", 0.2, (3.0, 1.5), meaning="edge of the sheet in space, seen from above"
)
TEXT = DrawingLayer("text", "#26262b")
