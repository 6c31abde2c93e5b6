"""One page about a design."""
