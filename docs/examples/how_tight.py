"""How tightly is a dome held? The smaller its held outline, the higher it rises.

Picture: preview-dome.png
"""

import asterism

data = asterism.new("dome").to_dict()
for scale in (0.70, 0.74, 0.78):
    data["pins"][0]["scale"] = scale
    shape = asterism.preview(asterism.Design.from_dict(data))
    print(f"outline at {scale:.0%} of its printed size: {shape.height_mm:.1f} mm high")
