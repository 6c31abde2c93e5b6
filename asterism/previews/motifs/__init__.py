"""Previews of the motif of drawn rods: fields of its law in place of those of stars."""
