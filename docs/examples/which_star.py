"""Which star matters: the three whose length changes the height of a dome most.

Picture: preview-dome.png
"""

import asterism

found = asterism.sensitivity(asterism.new("dome"), of="height_mm", by="length_mm")
for star in abs(found.derivatives).argsort()[::-1][:3]:
    print(f"star {found.stars[star]} at {found.centres[star].round(1)}: {found.derivatives[star]:+.2f} mm per mm")
