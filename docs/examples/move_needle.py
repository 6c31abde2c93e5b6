"""Where must a needle stand? Its place, for a point of the sheet that shall come to a given place.

Picture: canopy-4-needles.webp
"""

import asterism

canopy = asterism.Design.from_dict(
    {
        "stars": {"length_mm": 7.0},
        "border": {"rings": 2},
        "pins": [
            {"corners": [0, 2, 4], "scale": 0.75},
            {"points_mm": [[0.0, 0.0]], "target_mm": [[0.0, 0.0, 16.0]]},
        ],
    }
)
raised = asterism.solve_for_point(canopy, at_mm=(12.0, 0.0), point_mm=(9.0, 0.0, 20.0))
print("the needle stands at", raised.pins[1].target_mm)
