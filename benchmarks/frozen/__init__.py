"""Designs that are drawn and solved before the preview model changes: a first set of two halves, and later sets.

Models are chosen on the first two sets. A later set judges one model, after its last change, and the next change needs
a set of its own.
"""
