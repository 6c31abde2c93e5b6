"""A canopy on needles: two corners of a rectangle stand high, two low.

Picture: canopy-5-lifted.webp
"""

import asterism

corners = [[-45, -37.5, 30], [45, -37.5, 0], [45, 37.5, 30], [-45, 37.5, 0]]  # places in space, mm
canopy = asterism.Design.from_dict(
    {
        "name": "canopy",
        "stars": {"length_mm": 8.0},
        "border": {"rectangle_mm": [120, 100]},
        "pins": [{"where": "corners", "target_mm": corners}],
    }
)
shape = asterism.preview(canopy)
print("stands" if shape.summary["is_minimum"] else "does not stand", f"{shape.height_mm:.0f} mm high")
asterism.save_design(canopy, "canopy.toml")
