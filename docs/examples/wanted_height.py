"""A dome of a wanted height: one scale for the lengths of all stars.

Picture: dome.png
"""

import asterism

dome = asterism.solve_for(asterism.new("dome"), "height_mm", 14.0)
print(f"{asterism.preview(dome).height_mm:.2f} mm high")
asterism.save_design(dome, "dome-14.toml")
