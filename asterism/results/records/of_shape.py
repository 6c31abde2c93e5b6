"""The record of a shape, from data that may be of either model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from asterism.results.records.exact import ExactRecord
from asterism.results.records.preview import PreviewRecord

AnyShapeRecord = ExactRecord | PreviewRecord


def shape_record(data: Mapping[str, Any]) -> AnyShapeRecord:
    """The record of a shape's summary; without the key `model` it counts as the exact model's."""
    if isinstance(data, ExactRecord | PreviewRecord):
        return data
    kind = PreviewRecord if data.get("model") == PreviewRecord.model_name else ExactRecord
    return kind.from_json(data)
