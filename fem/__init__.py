"""Koiter shells on scikit-fem meshes: elements, energy, supports and loads, search for equilibria.

The input is a set of fields over the printed domain (rest metric, rest curvature, stiffness). Stars do not occur here.
"""
