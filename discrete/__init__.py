"""The exact model: discrete elastic rods (the arms) on the edges of a discrete shell (the fabric).

Rooms: `energies` (formulas and their derivatives), `model` (unknowns, supports, steps), `release` (from the stretched
print to a certified minimum).

Units: mm, N, MPa, N mm, rad. Array sizes in docstrings: V vertices, T triangles, R rod edges, S stencils (two rod edges
that meet) or stars, H hinges, E elements of one kind.
"""
