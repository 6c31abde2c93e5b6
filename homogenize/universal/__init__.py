"""The universal law: unit cells of all fabrics and plastics, as functions of dimensionless groups."""
