"""The discretisations over which tests are parametrised."""

from collections.abc import Callable
from typing import Any

from skfem import MeshTri

from asterism.fem.elements.argyris import Argyris
from tests.fem.bell import Bell
from tests.fem.lifted import Lifted

SPACES: dict[str, Callable[[MeshTri], Any]] = {"argyris": Argyris, "bell": Bell, "lifted": Lifted}
