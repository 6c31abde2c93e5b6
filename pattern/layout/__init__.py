"""The layout of a design: stars, arms, outline and supports in printed coordinates."""
