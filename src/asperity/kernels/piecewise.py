"""Piecewise polynomials of many columns at rising places, compiled."""

from __future__ import annotations

from asperity.kernels.options import LOOP, compiled


@compiled(**LOOP, fastmath={"contract"})
def evaluate_pieces(coefficients, breaks, places, values, slopes):  # type: ignore[no-untyped-def]
    """Values and slopes (places, columns) of polynomials by Horner's rule.

    `coefficients` (pieces, degree + 1, columns), highest power of the distance from `breaks` (pieces + 1,)
    first. The piece is looked for from that of the place before.
    """
    pieces, powers, columns = coefficients.shape
    piece = 0
    for i in range(places.shape[0]):
        x = places[i]
        while piece + 1 < pieces and x >= breaks[piece + 1]:
            piece += 1
        while piece > 0 and x < breaks[piece]:
            piece -= 1
        t = x - breaks[piece]
        for j in range(columns):
            values[i, j] = coefficients[piece, 0, j]
            slopes[i, j] = 0.0
        for p in range(1, powers):
            for j in range(columns):
                slopes[i, j] = slopes[i, j] * t + values[i, j]
                values[i, j] = values[i, j] * t + coefficients[piece, p, j]
