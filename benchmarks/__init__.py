"""Timings and accuracy tables; each file is one command, `python -m benchmarks.NAME`."""
