"""Plastic on both sides: one half of the sheet curls down, the other half up.

Picture: both-sides.png
"""

import asterism

data = {"stars": {"length_mm": 10, "thickness_mm": 0.4}, "border": {"rings": 3}}
sheet = asterism.preview(asterism.Design.from_dict(data)).layout
below = [site for site, (x, _) in zip(sheet.sites.tolist(), sheet.centres, strict=True) if x > 1]
data["stars"]["override"] = [{"site": site, "side": "below"} for site in below]
wave = asterism.preview(asterism.Design.from_dict(data))
print(f"{len(below)} stars below, {wave.height_mm:.1f} mm high")
