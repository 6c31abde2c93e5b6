"""The discretisations that tests run over."""

from collections.abc import Callable
from typing import Any

from skfem import MeshTri

from fem.argyris import Argyris
from fem.bell import Bell
from fem.lifted import Lifted

SPACES: dict[str, Callable[[MeshTri], Any]] = {"argyris": Argyris, "bell": Bell, "lifted": Lifted}
