"""The discretisations that tests run over."""

from collections.abc import Callable
from typing import Any

from skfem import MeshTri

from fem.elements.argyris import Argyris
from fem.elements.bell import Bell
from fem.elements.lifted import Lifted

SPACES: dict[str, Callable[[MeshTri], Any]] = {"argyris": Argyris, "bell": Bell, "lifted": Lifted}
