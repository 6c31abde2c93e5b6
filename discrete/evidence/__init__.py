"""The evidence of an equilibrium: certificate, effort, and measures of its shape."""
