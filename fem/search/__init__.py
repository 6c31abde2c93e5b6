"""Initial guesses, equilibrium search, response."""
