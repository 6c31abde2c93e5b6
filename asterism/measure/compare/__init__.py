"""A shape against reality: a scan in space, or an outline from a photograph."""
