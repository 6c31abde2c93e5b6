"""Progress of a verification in numbers."""

from __future__ import annotations

import re
from collections.abc import Callable

from asterism.equilibrium.newton.minimise import Iteration

StageReport = Callable[[str, int, int], None]
# number of steps of a stage
WHOLE = 100
# share of the release on the coarsest mesh in the computing time of an exact shape; the finer meshes take the rest
RELEASE_SHARE = 0.5


class ExactProgress:
    """Counts the progress of an exact shape from the reports of `exact_shape`.

    Parameters
    ----------
    stage : name of the stage.
    tell : called with the stage, the number of completed steps, and the number of all steps.
    """

    def __init__(self, stage: str, tell: StageReport) -> None:
        self._stage, self._tell = stage, tell
        self._meshes: set[str] = set()
        self._done = 0
        tell(stage, 0, WHOLE)

    def report(self, text: str, iteration: Iteration) -> None:
        """Read the mesh and the share of the release from the name of a stage of `exact_shape`."""
        mesh, percent = re.match(r"(\d+) vertices", text), re.search(r"(\d+) %", text)
        if percent:
            share = RELEASE_SHARE * int(percent[1]) / 100.0
        else:  # each mesh takes a part of what the meshes before have left
            self._meshes.add(mesh[1] if mesh else "")
            # share of the finer meshes that are left after each mesh; how many there will be is not known
            share = RELEASE_SHARE + (1.0 - RELEASE_SHARE) * (1.0 - 0.6 ** len(self._meshes))
        # an unfinished stage stays below 100 %, and a repeated stage does not decrease the count
        self._done = max(self._done, min(int(WHOLE * share), WHOLE - 1))
        self._tell(self._stage, self._done, WHOLE)

    def finish(self) -> None:
        """Report that all steps are completed."""
        self._tell(self._stage, WHOLE, WHOLE)
