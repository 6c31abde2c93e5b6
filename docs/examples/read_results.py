"""Read results again: write a shape into a folder, and follow printed places in it.

Picture: preview-bell.png
"""

import asterism

asterism.write_results(asterism.preview(asterism.new("bell")), "bell")
shape = asterism.read_shape("bell")
for x in (0.0, 20.0, 40.0):
    print(f"printed at x = {x:.0f} mm, in space at {shape.at([[x, 0.0]])[0].round(1)} mm")
