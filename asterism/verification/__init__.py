"""The preview held against the exact model: both shapes of a design, compared at the same printed points."""
