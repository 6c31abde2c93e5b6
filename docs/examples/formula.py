"""Sizes by a formula: long arms in a ring, short ones inside and outside.

Picture: fig9-linear.png
"""

import asterism

data = asterism.new("dome").to_dict()
data["name"] = "crater"
data["stars"]["length_mm"] = {"formula": "4 + 6*exp(-((r - 30)/15)**2)"}  # r: distance from the middle, mm
crater = asterism.preview(asterism.Design.from_dict(data))
middle, ring = crater.at([[0.0, 0.0], [30.0, 0.0]])[:, 2]
print(f"the ring is {ring - middle:.1f} mm higher than the middle")
