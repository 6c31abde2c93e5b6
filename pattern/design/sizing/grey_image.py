"""Reading pictures as grey values, and storing them as text."""

from __future__ import annotations

import base64
import warnings
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asterism.equilibrium.arrays import Floats

MAX_PIXELS_A_SIDE = 256
MAX_IMAGE_BYTES = 50_000_000
Grey = NDArray[np.uint8]


class ImageError(Exception):
    """A picture that cannot be read."""


def read_grey(path: Path) -> Grey:
    """(rows, columns) grey values 0-255 of a picture, scaled down to at most 256 pixels a side.

    Raises `ImageError` if there is no such file, it is too large, or it is not a picture.
    """
    from PIL import Image, ImageOps  # slow to import, rarely used

    with opened_picture(path) as picture:
        # a photograph may be stored rotated, with a note of how
        upright = ImageOps.exif_transpose(_eight_bits(picture)).convert("RGBA")
        page = Image.new("RGBA", upright.size, "white")  # transparent parts show white paper
        page.alpha_composite(upright)
        grey = page.convert("L")
        grey.thumbnail((MAX_PIXELS_A_SIDE, MAX_PIXELS_A_SIDE), Image.Resampling.BOX)
        return np.asarray(grey)


@contextmanager
def opened_picture(path: Path) -> Iterator[Any]:
    """The picture of pillow in a file of an allowed size; what goes wrong within the block is an `ImageError`, too."""
    from PIL import Image, UnidentifiedImageError

    try:
        if not path.is_file():
            raise ImageError(
                "must be a file" if path.is_dir() else f"there is no such file in {path.parent.absolute()}"
            )
        if path.stat().st_size > MAX_IMAGE_BYTES:
            raise ImageError(f"must be at most {MAX_IMAGE_BYTES // 1_000_000} MB")
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            with Image.open(path) as picture:
                if picture.width * picture.height > 80_000_000:
                    raise Image.DecompressionBombError
                yield picture
    except (Image.DecompressionBombError, Image.DecompressionBombWarning):
        raise ImageError("has too many pixels") from None
    except (OSError, ValueError, SyntaxError, UnidentifiedImageError):
        raise ImageError("is not a picture that can be read (PNG, JPEG, ...)") from None


def check_pixel_format(picture: Any) -> None:
    """Raise ImageError if the numbers of black and white are unknown."""
    if picture.mode == "F":
        raise ImageError("has numbers in place of grey values: save it with 8 or 16 bits a pixel")
    if picture.mode == "I" and picture.format != "PNG":
        raise ImageError("has 32 bits a pixel: save it with 8 or 16")


def _eight_bits(picture: Any) -> Any:
    """A grey picture of 16 bits a pixel with 8; others as they are."""
    from PIL import Image

    check_pixel_format(picture)
    if not picture.mode.startswith("I"):
        return picture
    values = np.asarray(picture, dtype=float)
    reduced = Image.fromarray(np.round(values * (255 / 65535)).astype(np.uint8))
    reduced.info = picture.info  # how it is rotated
    return reduced


def pack_image(grey: Grey) -> str:
    """Grey values compressed as text.

    >>> unpack_image(pack_image(np.array([[0, 255]], dtype=np.uint8)), 1, 2).tolist()
    [[0.0, 1.0]]
    """
    return base64.b64encode(zlib.compress(grey.tobytes(), 9)).decode("ascii")


def unpack_image(text: str, rows: int, columns: int) -> Floats:
    """(rows, columns) grey values from 0 (black) to 1 (white) of a text made by `pack_image`.

    Raises `ValueError`, `zlib.error` or `binascii.Error` if the text does not hold that many values.
    """
    packed = base64.b64decode(text, validate=True)
    raw = zlib.decompressobj().decompress(packed, MAX_PIXELS_A_SIDE**2)  # bounded, whatever the text claims to hold
    return np.asarray(np.frombuffer(raw, dtype=np.uint8).reshape(rows, columns) / 255)
