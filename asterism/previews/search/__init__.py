"""The search for the equilibrium."""
