"""The files for the printer: solids, 1:1 layouts, needles and instructions.

Picture: sheet-layout.png
"""

from pathlib import Path

import asterism

asterism.export(asterism.new("roof"), "roof-print", asterism.ExportSettings(printer="ultimaker2", preview=True))
print(sorted(path.name for path in Path("roof-print").iterdir()))
