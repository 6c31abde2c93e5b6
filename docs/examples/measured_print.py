"""A print and its shape: how far is a scan from the computed surface?

Picture: dome.png
"""

import numpy as np
import trimesh

import asterism

shape = asterism.preview(asterism.new("dome"))
noise = np.random.default_rng(0).normal(0.0, 0.3, shape.positions.shape)  # mm, in place of a real scan
trimesh.Trimesh(shape.positions + noise, shape.triangles).export("scan.obj")
found = asterism.compare(shape, "scan.obj")
print(f"{found.summary['rms_percent']:.2f} % of the diameter")
asterism.write_comparison(found, "dome-compared")
