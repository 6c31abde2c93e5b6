"""What is known of an equilibrium."""
