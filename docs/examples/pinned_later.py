"""Release first, pin later: supports that take hold of the free sheet.

Picture: bell.png
"""

import asterism

data = asterism.new("dome").to_dict()
data["border"] = {"rings": 2}
data["pins"] = [{"corners": [0, 2, 4], "scale": 0.7, "step": 1}]
data["mesh"] = {"edge_mm": 4.0}
later = asterism.simulate(asterism.Design.from_dict(data), starts=1)
print(f"{later.height_mm:.1f} mm high, {later.summary['energy_n_mm']:.0f} N mm")
