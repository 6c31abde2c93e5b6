"""A printed ring: its tense fabric turns it into a saddle.

Picture: ring.png
"""

import asterism

ring = asterism.Design.from_dict(
    {
        "name": "ring",
        "rods": {"thickness_mm": 0.6, "draw": [{"name": "rim", "circle_mm": {"radius": 40}}]},
        "border": {"rods": "rim"},
        "mesh": {"edge_mm": 5.0},
    }
)
saddle = asterism.simulate(ring)
print(f"{saddle.height_mm:.0f} mm high, minimum: {saddle.summary['is_minimum']}")
