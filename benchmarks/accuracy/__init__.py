"""How far the preview is from the exact model, over the gallery and over designs drawn at random."""
