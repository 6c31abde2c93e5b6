"""Your own fabric: a thinner one, whose unit cells are solved first and kept.

Picture: own-fabric.png
"""

import asterism

data = asterism.new("dome").to_dict()
data["name"] = "own-fabric"
data["fabric"] = {"thickness_mm": 0.5, "stretch": 1.3}
data["stars"] = {"length_mm": 7.0, "thickness_mm": 0.25}  # equal stars need one cell
shape = asterism.preview(asterism.Design.from_dict(data), say=print)
print(f"{shape.height_mm:.1f} mm high")
shape.picture("oblique", size_px=(840, 600), plain=True).save("own-fabric.png")
