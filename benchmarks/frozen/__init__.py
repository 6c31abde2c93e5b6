"""Designs that were drawn and solved before the preview model was changed: two halves of a first set, and a second set.

The second set is sealed and judges the changes of the preview model. It is opened once, after the last of them: until
then nobody compares a preview with its exact shapes. `benchmarks.frozen.compare` opens it only with --open-second-set.
It judged the model of 26 November 2026; the next change needs a set of its own.
"""
