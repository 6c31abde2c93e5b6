"""A shell of your own: a disk whose rest metric is that of a sphere.

Picture: shell.svg
"""

import numpy as np
from skfem import MeshTri

from asterism.fem.elements.argyris import Argyris
from asterism.fem.search.relax import relax
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import of_stretch
from asterism.fem.shell.shell import Shell

mesh = MeshTri.init_circle(1)
mesh = MeshTri(50.0 * mesh.p, mesh.t)  # a disk of radius 50 mm
sheet = Density(isotropic(membrane=20.0, bending=1.0, poisson=0.3))  # N/mm and N mm
shrunk = of_stretch(sheet, stretch=lambda p: 1 / (1 + (p**2).sum(axis=-1) / 1e4), curvature=1e-3)
shell = Shell(Argyris(mesh), shrunk)
found = relax(shell)
places = shell.space.locate(np.array([[0.0, 0.0], [49.0, 0.0]])).value @ found.x
print("minimum:", found.is_minimum, f"and {abs(places[1, 2] - places[0, 2]):.1f} mm deep")
