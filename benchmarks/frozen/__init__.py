"""Designs that were drawn and solved before the preview model was changed: a first set of two halves, and later sets.

Models are chosen on the first two sets. The third judged the model of 26 November 2026, after its last change, and is
open since. The next change needs a set of its own.
"""
