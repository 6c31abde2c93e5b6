"""The layout of a design: stars, arms, outline and pins in print coordinates."""
