"""Designs that were drawn and solved before the preview model was changed: two halves of a first set, and a second set.

The second set judged the model of 26 November 2026, after its last change, and is open since. The next change needs a
set of its own.
"""
