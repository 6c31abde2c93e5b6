"""80 designs that were drawn and solved before the preview model was changed: a half to work with, a sealed half.

The sealed half judges the changes of the preview model. It is opened once, after the last of them: until then nobody
compares a preview with its exact shapes. `benchmarks.frozen.compare` opens it only with --open-sealed-half.
"""
