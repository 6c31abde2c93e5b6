"""The print of a sheet: its design, its layout and its meshes. Pure data and geometry.

The rooms, in the order in which they build on each other:

geometry
    Arrays, plane lattices, polygons, triangles and rigid motions. It imports no other room.
drawing
    Lines of drawings of other programs: SVG, DXF and 3DM.
design
    The design file: its sections, sizing profiles and errors.
rods
    Printed rods: the arms of the stars.
layout
    The layout of a design: stars, arms, outline and supports in printed coordinates; its symmetries.
mesh
    Triangle meshes of a layout: aligned with the lattice, free, or coarse.

A room imports the rooms above it in this list only. The gallery holds designs of the paper's figures.
"""
