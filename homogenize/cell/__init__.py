"""The periodic unit cell: one star of an endless sheet, flat or rolled to a tube.

Conventions of this room:

- Lengths are in mm, forces in N, angles in rad. Energies, stiffnesses and moments are per area of the print.
- The print is the plane of the stretched fabric; its coordinates are X, the lattice vectors A1 and A2.
- The plastic lies on the side of positive z. Curvatures are positive with the plastic on the outside: the edges of such
  a sheet go down.
- Voigt vectors are (11, 22, 2 x 12), for the strain `E = (a - a_r)/2` and for the curvature (second fundamental form).
- On a tube, an angle is counted counterclockwise from the print's y axis to the printed direction around the tube.
- "Curl" is a curvature times the spacing of the stars, without dimension.
"""
