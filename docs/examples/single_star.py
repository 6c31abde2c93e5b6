"""One star, by both models: how high it bumps.

Picture: star.png
"""

import asterism

star = asterism.new("star")
exact = asterism.simulate(star)
print(f"exact {exact.height_mm:.2f} mm, preview {asterism.preview(star).height_mm:.2f} mm")
print("certified minimum:", exact.summary["is_minimum"])
