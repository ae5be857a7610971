"""Mode shapes at equally spaced places, compiled: sines turn by a fixed angle, exponentials by a factor."""

from __future__ import annotations

from asperity.kernels.options import LOOP, compiled

STRIDE = 128
"""Places that follow from one exact value; rounding does not tell over so many."""


@compiled(**LOOP, fastmath={"contract"})
def turn_on(wave, slope, turn, shapes, slopes):  # type: ignore[no-untyped-def]
    """Sinusoidal parts of mode shapes, and their slopes, into (places, modes).

    `wave` and `slope` (blocks, modes) are exact at the first place and at every `STRIDE` places from there.
    `turn` (3, modes) is 1 − cos(k d), sin(k d)/k and k sin(k d) of the wavenumber k and the distance d of the
    places: the difference from one, small where places are close, adds less rounding than the cosine.
    """
    modes = turn.shape[1]
    for i in range(shapes.shape[0]):
        if i % STRIDE == 0:
            for j in range(modes):
                shapes[i, j], slopes[i, j] = wave[i // STRIDE, j], slope[i // STRIDE, j]
        else:
            for j in range(modes):
                a, b = shapes[i - 1, j], slopes[i - 1, j]
                shapes[i, j] = a + (turn[1, j] * b - turn[0, j] * a)
                slopes[i, j] = b - (turn[2, j] * a + turn[0, j] * b)


@compiled(**LOOP, fastmath={"contract"})
def add_near_fields(near, growth, shapes, slopes):  # type: ignore[no-untyped-def]
    """Add to mode shapes and slopes (places, modes) the exponentials beside the ends.

    `near` (2, blocks, modes) holds exact values of the parts that rise and that fall along the places, as in
    `turn_on`, and is overwritten; `growth` (3, modes) their factors from place to place, and the wavenumber.
    """
    modes = growth.shape[1]
    for i in range(shapes.shape[0]):
        block = i // STRIDE
        for j in range(modes):
            rising, falling = near[0, block, j], near[1, block, j]
            shapes[i, j] += rising + falling
            slopes[i, j] += growth[2, j] * (rising - falling)
            near[0, block, j], near[1, block, j] = rising * growth[0, j], falling * growth[1, j]
