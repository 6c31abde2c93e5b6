"""From the stretched print to a certified equilibrium."""
