"""A design on one page: picture, layout, needles and print time as PDF.

Picture: sheet-needles.png
"""

import asterism

roof = asterism.new("roof")
asterism.save_design(roof, "roof.toml")
asterism.report(roof, "roof.pdf", printer="ultimaker2")
