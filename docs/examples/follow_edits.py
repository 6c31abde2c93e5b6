"""Follow edits: a preview that keeps its state, while needles move together.

Picture: preview-roof.png
"""

import asterism

roof = asterism.new("roof")
preview = asterism.Preview(roof)
for share in (1.0, 0.98, 0.96):
    data = roof.to_dict()
    places = data["pins"][0]["target_mm"]
    data["pins"][0]["target_mm"] = [[share * x, share * y, z] for x, y, z in places]
    shape = preview.update(asterism.Design.from_dict(data))
    print(f"needles at {share:.0%}: {shape.height_mm:.1f} mm high")
