"""Triangle meshes of a printed sheet."""
