"""Pictures to scale: a dome from above and from the side, without titles.

Picture: verified.png
"""

import asterism

dome = asterism.preview(asterism.new("dome"))
for view in ("above", "side"):
    dome.picture(view, size_px=(800, 600), plain=True).save(f"dome-{view}.png")
