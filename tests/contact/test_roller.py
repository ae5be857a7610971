"""A roller solved as a half-space: Lundberg's closed form, how far slices are from it, edges."""

import numpy as np
import pytest

from asperity import Crowning, LineContact, SlicedContact
from asperity.contact.roller import solved_roller
from asperity.errors import HalfSpaceWarning
from refusals import refusals

MODULUS, RADIUS, LENGTH = 113.7e9, 3.03e-3, 7.8e-3  # of NU 205, inner ring
ISO = Crowning.iso(LENGTH, 7.5e-3)


def roller(crowning):
    return SlicedContact(MODULUS, RADIUS, crowning)


@pytest.mark.filterwarnings("ignore::asperity.errors.HalfSpaceWarning")  # its ends carry as its middle does
def test_lundbergs_profile_makes_the_pressure_even_and_his_approach():
    """At the load that it is for: Hertz's pressure but for the ends, and the closed form of the approach."""
    line = LineContact(MODULUS, RADIUS, LENGTH)
    found = solved_roller(roller(Crowning.lundberg(line, 900.0)), 900.0, cells=(10, 101))
    assert found.approach == pytest.approx(line.approach(900.0), rel=0.01)
    middle = np.abs(found.places) < 0.4 * LENGTH
    assert found.line_load[middle] == pytest.approx(900.0 / LENGTH, rel=0.02)
    assert found.pressure[middle] == pytest.approx(line.peak_pressure(line.approach(900.0)), rel=0.02)
    assert found.contact.force == pytest.approx(900.0, rel=1e-6)
    assert found.moment == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("crowning", [
    ISO, Crowning("partial", LENGTH, 10e-6, 4e-3), Crowning("circular", LENGTH, 12e-6),
])  # fmt: skip
@pytest.mark.parametrize("force", [200.0, 900.0])
def test_slices_of_crowned_rollers_are_within_tenths_of_the_half_space(crowning, force):
    """Approach within 6 %, largest pressure within 9 %, tilted by 1.7' within 13 %; no less is claimed."""
    sliced = roller(crowning)
    straight = solved_roller(sliced, force)
    approach = sliced.approach(force)
    assert approach == pytest.approx(straight.approach, rel=0.06)
    assert sliced.peak_pressure(approach) == pytest.approx(straight.pressure.max(), rel=0.09)
    tilted = solved_roller(sliced, force, 5e-4)
    pressed = sliced.pressed(np.linspace(0.5, 1.2, 1401) * approach, 5e-4)
    loads = pressed.loads[np.abs(pressed.force - force).argmin()]
    assert sliced.pressures(loads).max() == pytest.approx(tilted.pressure.max(), rel=0.13)
    assert tilted.moment == pytest.approx(loads @ sliced.places, rel=0.25)
    assert tilted.moment > 0.0


def test_the_pressure_at_a_sharp_end_grows_with_finer_cells_and_is_told():
    """It has a singularity there, which slices do not see: their pressure is that of the middle."""
    sharp = roller(Crowning("cylindrical", LENGTH))
    peaks = []
    for along in (51, 101, 201):
        with pytest.warns(HalfSpaceWarning, match=r"An end of the roller carries \d\d\d % of the largest"):
            found = solved_roller(sharp, 900.0, cells=(6, along))
        peaks.append(found.pressure.max())
        assert found.pressure.argmax() in (0, along - 1)
        assert found.pressure[along // 2] == pytest.approx(
            sharp.peak_pressure(sharp.approach(900.0)), rel=0.06
        )
    assert peaks[2] > 1.15 * peaks[1] > 1.3 * peaks[0]


test_what_cannot_be_solved_is_refused = refusals(
    (lambda: solved_roller(roller(ISO), 0.0), "force"),
    (lambda: solved_roller(roller(ISO), 1.0, 0.5), "tilt"),
    (lambda: solved_roller(roller(ISO), 1.0, cells=(2, 50)), "cells of the roller: received 2.*4 or more"),
    (lambda: solved_roller(roller(ISO), 1.0, cells=(8, 5)), "cells of the roller: received 5.*30 or more"),
)
