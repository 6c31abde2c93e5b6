"""Homogenisation: the constitutive law of the star pattern from periodic unit cells.

Three rooms, each of which imports only those before it: `cell` solves one unit cell (the representative volume of an
endless sheet of equal stars), `law` holds the fitted functions, `campaign` solves many cells and fits them.
"""
