"""Sparsity patterns with room for entries that come and go."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from asterism.discrete.model.contact_model import sorted_union

NUMBERS = st.lists(st.integers(-(2**62), 2**62)).map(lambda numbers: np.array(numbers, dtype=np.int64))


@given(NUMBERS, NUMBERS)
def test_united_numbers_are_those_of_both_in_order_and_once(one: np.ndarray, other: np.ndarray) -> None:
    assert sorted_union(one, other).tolist() == sorted({*one.tolist(), *other.tolist()})
