"""Print one of the README's commands: those a newcomer copies are those that are tested."""

import re
import sys
from pathlib import Path

README = Path(__file__).parents[1] / "README.md"


def command(name: str) -> str:
    """The line in the code block after the comment `<!-- name -->`."""
    blocks = re.findall(rf"<!-- {name} -->\n```sh\n(.*?)\n```", README.read_text(encoding="utf-8"), re.DOTALL)
    if len(blocks) != 1 or "\n" in blocks[0]:
        raise SystemExit(f"README.md must have one block of one line after <!-- {name} -->")
    return blocks[0]


if __name__ == "__main__":
    print(command(sys.argv[1]))
