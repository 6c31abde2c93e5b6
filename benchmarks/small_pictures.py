"""Screenshots as the documentation holds them: WebP, which takes a tenth of the room.

python -m benchmarks.small_pictures FOLDER    (FOLDER: that of `python -m benchmarks.studio_pictures`)

Turns FOLDER/NAME-1280-SCHEME.png into docs/pictures/studio-NAME-SCHEME.webp.
"""

from __future__ import annotations

import sys
from io import BytesIO
from pathlib import Path

from PIL import Image

QUALITY = 78  # of 100: text stays sharp
EFFORT = 6  # the most that Pillow offers


def write_small(png: bytes, path: Path) -> None:
    """Write a picture that was taken as PNG."""
    Image.open(BytesIO(png)).convert("RGB").save(path, quality=QUALITY, method=EFFORT)


def main(folder: Path) -> None:
    docs, total = Path(__file__).parents[1] / "docs" / "pictures", 0
    for picture in sorted(folder.glob("*-1280-*.png")):
        small = docs / f"studio-{picture.stem.replace('-1280', '')}.webp"
        write_small(picture.read_bytes(), small)
        total += small.stat().st_size
        print(f"{small.name}: {small.stat().st_size / 1e3:.0f} kB")
    print(f"all: {total / 1e3:.0f} kB")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        raise SystemExit(__doc__)
    main(Path(sys.argv[1]))
