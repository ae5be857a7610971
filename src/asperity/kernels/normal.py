"""Standard normal deviates, compiled: those that NumPy's generators make of Philox's random words.

Words are drawn from a counter in ten rounds (J. K. Salmon et al., Proc. SC11, 2011). Deviates are made of
them by the ziggurat (G. Marsaglia and W. W. Tsang, J. Stat. Softw. 5 (2000) 8): half the bell is covered with
boxes of one area that lie on each other, the lowest of which has the tail. Of a word eight bits choose a box,
one the sign and 52 the place across; where the box above covers the place too, 99 in 100 times, it is kept.
NumPy branches at the sign, which no processor foresees, and asks for word after word: that takes three times
as long.
"""

import math
from functools import cache
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from numpy.typing import NDArray

from asperity.kernels.options import CALLED, INNER, LOOP, compiled

BOXES = 256
TAIL = 3.6541528853610088
"""Where the tail begins."""
PLACES = 2.0**52
"""Places across a box."""
_BOX = np.uint64(BOXES - 1)
_ONE = np.uint64(1)
_PLACE = np.uint64(2**52 - 1)
_TO_SIGN = np.uint64(8)
_TO_PLACE = np.uint64(9)
_TO_UNIT = np.uint64(11)
_TO_SIGN_OF_TAIL = np.uint64(17)
_FACTORS = np.uint64(0xD2E7470EE14C6C93), np.uint64(0xCA5A826395121157)
_STEPS = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xBB67AE8584CAA73B)
WORDS = 2**12
"""Random words that are drawn at a time: they stay in the processor's first cache."""


@cache
def boxes() -> tuple[NDArray, NDArray, NDArray]:
    """Width of each box per place, places that lie below the box above it too, and heights exp(−x²/2)."""
    area = TAIL * math.exp(-0.5 * TAIL**2) + math.sqrt(0.5 * math.pi) * math.erfc(TAIL / math.sqrt(2.0))
    edges = [TAIL]
    for _ in range(BOXES - 2):
        edges.append(math.sqrt(-2.0 * math.log(area / edges[-1] + math.exp(-0.5 * edges[-1] ** 2))))
    edge = np.array([0.0, *edges[::-1]])
    width = edge.copy()
    width[0] = area * math.exp(0.5 * TAIL**2)
    below = np.concatenate([[TAIL], edge[:-1]])
    return width / PLACES, (PLACES * below / width).astype(np.uint64), np.exp(-0.5 * edge**2)


_instruction: Any = intrinsic


@_instruction
def _high(typing: Any, first: Any, second: Any) -> Any:
    """Upper 64 bits of a product of two words."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        whole = ir.IntType(128)
        product = builder.mul(*(builder.zext(each, whole) for each in arguments))
        return builder.trunc(builder.lshr(product, ir.Constant(whole, 64)), ir.IntType(64))

    return types.uint64(first, second), generate


@compiled(**CALLED, nogil=True)
def _draw(key, counter, words, first, last):  # type: ignore[no-untyped-def]
    """Put random words, fours of them, in places from one to before another, and count them."""
    for i in range(first, last, 4):
        counter[0] += _ONE
        a, b, c, d = counter[0], counter[1], counter[2], counter[3]
        p, q = key[0], key[1]
        for _ in range(10):
            e = _high(_FACTORS[1], c) ^ b ^ p
            f = _high(_FACTORS[0], a) ^ d ^ q
            a, b, c, d = e, _FACTORS[1] * c, f, _FACTORS[0] * a
            p += _STEPS[0]
            q += _STEPS[1]
        words[i], words[i + 1], words[i + 2], words[i + 3] = a, b, c, d


@compiled(**INNER, nogil=True)
def _unit(word):  # type: ignore[no-untyped-def]
    """Number from 0 to 1, without it, of a word."""
    return np.float64(word >> _TO_UNIT) * 2.0**-53


@compiled(**CALLED, nogil=True)
def _fill(words, last, width, below, height, found, begin):  # type: ignore[no-untyped-def]
    """Fill `found` from a place on, of words before the last; return the place then, and how many it took."""
    used = 0
    for i in range(begin, found.size):
        at = used
        waited = True
        while waited:
            if at + 2 > last:
                return i, used
            word = words[at]
            box = np.int64(word & _BOX)
            place = (word >> _TO_PLACE) & _PLACE
            x = np.float64(place) * width[box]
            found[i] = x * (1.0 - 2.0 * np.float64((word >> _TO_SIGN) & _ONE))
            waited = place >= below[box]
            at += 1
            if waited and box > 0:
                share = _unit(words[at])
                at += 1
                waited = (height[box - 1] - height[box]) * share + height[box] >= math.exp(-0.5 * x * x)
            while waited and box == 0:
                if at + 2 > last:
                    return i, used
                outside = -math.log1p(-_unit(words[at])) / TAIL
                above = -math.log1p(-_unit(words[at + 1]))
                at += 2
                found[i] = (TAIL + outside) * (1.0 - 2.0 * np.float64((word >> _TO_SIGN_OF_TAIL) & _ONE))
                waited = 2.0 * above <= outside * outside
        used = at
    return found.size, used


@compiled(**LOOP, nogil=True)
def normal_deviates(key, counter, words, width, below, height, found):  # type: ignore[no-untyped-def]
    """Fill `found` (n,), with the boxes, from a key (2,) and a counter (4,) of words on; `words` is room."""
    filled = 0
    left = 0
    while filled < found.size:
        needed = (found.size - filled) * 65 // 64 + 8 - left  # of 80 deviates one takes two words
        last = left + min(max(needed, 4), words.size - left) // 4 * 4
        _draw(key, counter, words, left, last)
        filled, used = _fill(words, last, width, below, height, found, filled)
        left = last - used
        for i in range(left):
            words[i] = words[used + i]
