"""The exact model: discrete elastic rods on a discrete shell."""
