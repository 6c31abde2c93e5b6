"""The Koiter shell: strains, energy density, assembly."""
