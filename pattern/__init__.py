"""What is printed: materials, lattice, sizing fields, border, pins and mesh. Pure data and geometry."""
