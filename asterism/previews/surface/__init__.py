"""The smooth surface of the shell, and the shape with the bumps of its stars."""
