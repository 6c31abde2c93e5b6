"""Search for equilibria of the shell: initial guesses, Newton's method with mixed points, certificate, response."""
