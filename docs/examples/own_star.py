"""Your own star: four arms on a square lattice.

Picture: own-star.png
"""

import asterism

design = asterism.Design.from_dict(
    {
        "name": "own-star",
        "lattice": {"kind": "square", "arms": 4, "spacing_mm": 16.0},
        "stars": {"length_mm": 7.0, "thickness_mm": 0.4},
        "border": {"rectangle_mm": [64, 64]},
        "mesh": {"edge_mm": 3.0},
    }
)
shape = asterism.simulate(design, starts=1)
print(f"{shape.height_mm:.1f} mm high, minimum: {shape.summary['is_minimum']}")
shape.picture("oblique", size_px=(840, 600), plain=True).save("own-star.png")
