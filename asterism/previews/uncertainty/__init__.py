"""Estimated error of a preview; the entry point is `asterism.previews.uncertainty.estimate.estimate_error`."""
