"""A printer with the values of command-line options."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import ValidationError

from asterism.pattern.design.errors import DesignError, from_validation
from asterism.print.printer import Printer


def adjusted_printer(
    machine: Printer,
    first_layer: float | None = None,
    layer: float | None = None,
    plate: float | None = None,
    frame: Sequence[float] | None = None,
) -> Printer:
    """The printer with other layer heights (mm), another thickness of the plate (mm) and another frame (2,) mm.

    Values that are not given stay.

    Raises
    ------
    DesignError
        An option is out of range.
    """
    data = machine.model_dump(mode="json")
    data["first_layers_mm"] = data["first_layers_mm"] if first_layer is None else [first_layer]
    data["layer_mm"] = data["layer_mm"] if layer is None else layer
    data["frame"]["plate_mm"] = data["frame"]["plate_mm"] if plate is None else plate
    data["frame"]["size_mm"] = data["frame"]["size_mm"] if frame is None else list(frame)
    options = {"first_layers_mm[0]": "--first-layer", "layer_mm": "--layer", "frame.plate_mm": "--plate"}
    options |= {f"frame.{name}": "--frame" for name in ("size_mm", "bar_mm")}
    try:
        return Printer.model_validate(data)
    except ValidationError as error:
        wrong = from_validation(error)
        raise DesignError(options.get(wrong.field, wrong.field), wrong.allowed, wrong.value) from None
