"""A sheet that rolls up: 37 equal stars without supports.

Picture: preview-tube.png
"""

import asterism

tube = asterism.preview(asterism.new("tube"))
print(f"a tube of radius {tube.summary['roll_radius_mm']:.1f} mm, {tube.height_mm:.1f} mm high")
print(f"estimated error: {tube.summary['expected_rms_percent']:.1f} % of the diameter")
