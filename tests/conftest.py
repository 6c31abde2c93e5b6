"""Tests run side by side: each worker keeps to one thread, or they would wait for each other."""

import os
import signal

for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")
# pictures are made without a display, also where a test draws on its own
os.environ.setdefault("MPLBACKEND", "Agg")
# a shell that starts the tests in the background has them ignore Ctrl-C, and with them every program they start
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
