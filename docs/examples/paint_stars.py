"""Paint single stars: a long one in the middle, and one that is left out.

Picture: studio-brush-light.webp
"""

import asterism

data = asterism.new("dome").to_dict()
data["stars"]["override"] = [{"site": [0, 0], "length_mm": 12.0}, {"site": [1, 0], "remove": True}]
shape = asterism.preview(asterism.Design.from_dict(data))
print(f"{shape.height_mm:.1f} mm high, {len(shape.star_vertices)} stars")
