"""Laws for users: material files, calibration, tables."""
