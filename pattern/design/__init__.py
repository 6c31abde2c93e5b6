"""The design file: its sections, and one-line errors."""
