"""A tube of a wanted radius: one scale for the lengths of all stars.

Picture: tube.png
"""

import asterism

tube = asterism.solve_for(asterism.new("tube"), "roll_radius_mm", 25.0)
print(f"arms of {tube.stars.length_mm:.2f} mm")
asterism.save_design(tube, "tube-25.toml")
