"""A net of rhombi: a motif that repeats, whose unit cell is solved first.

Picture: net.png
"""

import asterism

net = asterism.Design.from_dict(
    {
        "name": "net",
        "lattice": {"kind": "custom", "vectors_mm": [[9.0, 0.0], [4.5, 7.794]]},
        "rods": {"motif": [{"line_mm": [[0, 0], [9, 0]]}, {"line_mm": [[0, 0], [4.5, 7.794]]}]},
        "border": {"rectangle_mm": [50, 50]},
        "mesh": {"edge_mm": 2.5},
    }
)
shape = asterism.preview(net)
print(f"{shape.height_mm:.1f} mm high, estimated error {shape.summary['expected_rms_percent']:.1f} %")
