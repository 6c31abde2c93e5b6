"""Room of the homogenised shell on scikit-fem: it knows fields, not stars."""
