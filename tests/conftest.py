"""Tests run side by side: each worker keeps to one thread, or they would wait for each other."""

import os

for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")
# pictures are made without a display, also where a test draws on its own
os.environ.setdefault("MPLBACKEND", "Agg")
