"""A hole in the sheet: its edge is held above the ground.

Picture: hole.png
"""

import asterism

data = asterism.new("dome").to_dict()
data["name"] = "hole"
data["border"]["holes"] = [{"circle_mm": {"radius": 8}}]
data["pins"].append({"holes": [0], "scale": 0.8, "offset_mm": [0, 0, 18]})
shape = asterism.preview(asterism.Design.from_dict(data))
print(f"{shape.height_mm:.1f} mm high, {len(shape.star_vertices)} stars")
shape.picture("oblique", size_px=(840, 600), plain=True).save("hole.png")
