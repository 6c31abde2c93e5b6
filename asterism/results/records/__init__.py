"""The records of all results: one file for each kind of summary."""
