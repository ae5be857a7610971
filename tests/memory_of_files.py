"""Memory that reading a file takes beside its bytes."""

import tracemalloc

import numpy as np


def single_digits(path, samples):
    """Write a column of them."""
    path.write_text("\n".join(map(str, np.abs(samples) % 10)) + "\n")


def times_of_file(path, write, evaluate, shorter=100_000):
    """Bytes of memory a byte of a file of whole numbers of two bytes: what a file of three times the numbers
    takes more than a shorter one, which holds so many that what does not grow hides nothing."""
    peaks = []
    sizes = []
    for count in (20_000, shorter, 3 * shorter):  # the first for imports
        write(path, np.random.default_rng(0).integers(-9_999, 10_000, count, dtype=np.int16))
        sizes.append(path.stat().st_size)
        tracemalloc.start()
        try:
            evaluate()
            peaks.append(tracemalloc.get_traced_memory()[1])
        finally:
            tracemalloc.stop()
    return (peaks[2] - peaks[1]) / (sizes[2] - sizes[1])
