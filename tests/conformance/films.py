"""Checks of films of oil: a printed problem, and Reynolds' equation over elastic bodies."""

import math
from functools import partial

from ledger import Check

from asperity.contact.film import ELLIPSES, LINES, Groups
from reynolds_lines import solved_film


def ball_that_rolls_down_a_plate():
    """A steel ball of 30 mm rolls down 45° from rest.

    The book takes 1/R' = 1/R_x + 1/R_y, k = 1.0339, and half the speed of the ball.
    """
    modulus, radius = 2.1e11 / (1.0 - 0.3**2), 7.5e-3
    weight = 7800.0 * math.pi / 6.0 * 30e-3**3 * 9.81
    source = "G. W. Stachowiak and A. W. Batchelor, Engineering Tribology, problem of chapter 7, as printed"
    row = partial(Check, source=source, tolerance=5.1e-4, absolute=True)
    for rolled, printed in ((0.01, 0.059e-6), (1.0, 0.281e-6)):
        speed = math.sqrt(10.0 / 7.0 * 9.81 * rolled * math.sin(math.pi / 4))
        groups = Groups(
            50e-3 * 0.5 * speed / (modulus * radius),
            2.2e-8 * modulus,
            weight * math.cos(math.pi / 4) / (modulus * radius**2),
            1.0339,
        )
        found = radius * ELLIPSES.minimum.thickness(groups)
        yield row(f"ball of 30 mm that has rolled {rolled:g} m down 45°: least film", printed, found, "µm")


def lines():
    """Films of line contacts over the radius, at numbers of roller bearings."""
    numbers = 2e-11, 5000.0, 1e-4
    source = "Reynolds' equation and an elastic half-plane, Newton's method on 600 cells; tolerance: the fit"
    for name, compressed, tolerances in (("pan", True, (0.2, 0.1)), ("dowson", False, (0.02, 0.04))):
        formula = LINES[name]
        solved = solved_film(*numbers, compressed=compressed, inlet=4.0)
        fits = formula.central, formula.minimum
        oil = "an oil that is compressed" if compressed else "an oil that is not compressed"
        for what, fit, expected, tolerance in zip(
            ("central", "least"), fits, solved, tolerances, strict=True
        ):
            yield Check(
                f"line contact, U 2e-11, G 5000, W 1e-4, {oil}: {what} film over the radius, {formula.name}",
                expected, fit.thickness(Groups(*numbers)), source=source, tolerance=tolerance,
            )  # fmt: skip
