"""Memory that reading a file takes beside its bytes."""

import tracemalloc

import numpy as np


def times_of_file(path, evaluate):
    """Bytes of memory a byte of a file of single digits: what a longer one takes more than a shorter."""
    peaks = []
    for count in (20_000, 100_000, 300_000):  # the first for imports
        digits = np.random.default_rng(0).integers(0, 10, count)
        path.write_text("\n".join(map(str, digits)) + "\n")
        tracemalloc.start()
        try:
            evaluate()
            peaks.append(tracemalloc.get_traced_memory()[1])
        finally:
            tracemalloc.stop()
    return (peaks[2] - peaks[1]) / (2 * 200_000)
