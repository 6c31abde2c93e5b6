"""The fast preview: the law of a design's stars as fields over a shell, its shape, and the stars' bumps on it."""
