"""The Koiter shell: strains, energy density, fields, assembly, and the shell problem itself."""
