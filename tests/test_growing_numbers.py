"""Numbers that grow in number are as they were, and take a byte each where they have one digit."""

import tracemalloc
from itertools import pairwise

import numpy as np
import pytest

from asperity.growing_numbers import BLOCK, GrowingNumbers


@pytest.mark.parametrize(("values", "bytes_each"), [
    (np.arange(3 * BLOCK + 7.0) % 10.0, 1),
    (np.arange(3 * BLOCK + 7.0) % 128.0 - 128.0, 1),
    (np.arange(3 * BLOCK + 7.0) % 129.0, 2),
    (0.5 * (np.arange(3 * BLOCK + 7.0) % 999.0), 4),
    (np.where(np.arange(3.0 * BLOCK) % 3.0, 1.0, np.nan), 4),
    (np.where(np.arange(3.0 * BLOCK) % 3.0, 1.0, -0.0), 4),
    (np.arange(3 * BLOCK + 7.0) / 3.0, 8),
    (np.full(3 * BLOCK, 1e300), 8),
    (np.full(3 * BLOCK, np.inf), 4),
    (np.full(1, 40_000.0), 4),
])  # fmt: skip
def test_numbers_are_as_they_were_to_the_last_bit(values, bytes_each):
    numbers = GrowingNumbers()
    numbers.extend(values[:1])  # beside the block
    tracemalloc.start()
    try:
        for first, last in pairwise([*range(1, values.size, 999), values.size]):
            numbers.extend(values[first:last])
        assert len(numbers) == values.size
        held = tracemalloc.get_traced_memory()[0]
    finally:
        tracemalloc.stop()
    assert held < bytes_each * values.size + 10_000
    poured = numbers.poured()
    assert poured.tobytes() == values.tobytes()
    assert len(numbers) == 0


def test_more_numbers_than_a_block_and_rows_of_them_are_added_at_once():
    rows = np.arange(6.0 * BLOCK).reshape(-1, 3)
    numbers = GrowingNumbers()
    numbers.extend([])
    numbers.extend(rows)
    numbers.extend([1.5])
    np.testing.assert_array_equal(numbers.poured(), [*rows.reshape(-1), 1.5])
