"""Rest state and stiffness of the shell, from the law."""
