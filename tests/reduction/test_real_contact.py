"""The real contact of rough bodies: its area by Persson's theory, and asperities of a single cell."""

import numpy as np
import pytest
from scipy.special import erf

from asperity.contact import HalfSpace, Hertz
from asperity.reduction.stiffness import isolated_share
from asperity.surfaces.statistics import rms_slope
from asperity.surfaces.synthesis import self_affine

MODULUS = 115e9


def test_cells_that_touch_alone():
    pressure = np.zeros((6, 6))
    assert isolated_share(pressure) == 0.0
    pressure[0, 0] = 1.0
    pressure[3, 3] = pressure[3, 4] = 1.0
    pressure[5, 0] = 2.0
    assert isolated_share(pressure) == pytest.approx(3 / 5)
    pressure[4, 1] = 5.0  # neighbours across a corner do not count
    assert isolated_share(pressure) == pytest.approx(8 / 10)
    assert isolated_share(np.ones((4, 4))) == 0.0


@pytest.mark.parametrize("hurst", [0.5, 0.9])
@pytest.mark.parametrize("steepness", [0.4, 1.0, 2.0, 4.0])
def test_the_real_contact_area_is_that_of_persson(hurst, steepness):
    """Contacts of a ball; steepness is E* Sdq over Hertz's peak pressure.

    Persson's share of contact under a pressure p, erf(√π κ p/(2 E* Sdq)), averaged over Hertz's pressure:
    B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840; κ = 2.0: S. Hyun et al., Phys. Rev. E 70 (2004)
    026117 (not seen).
    """
    radius, load, spacing, cells = 25e-3, 30.0, 8e-6, 65
    hertz = Hertz(MODULUS, radius, radius)
    a = hertz.semi_axes(hertz.approach(load))[0]
    peak = 1.5 * load / (np.pi * a**2)
    texture = self_affine(
        (4 * cells, cells), (spacing, spacing), rms=1e-7, hurst=hurst, longest=0.2e-3, shortest=32e-6, seed=3
    )
    slope = steepness * peak / MODULUS
    heights = texture.heights * slope / rms_slope(texture)
    x = spacing * (np.arange(cells) - cells // 2)
    ball = (x[:, None] ** 2 + x**2) / (2 * radius)
    half_space = HalfSpace((cells, cells), (spacing, spacing), MODULUS)
    smooth = half_space.solve(ball, load=load).area
    pieces = [heights[i * cells : (i + 1) * cells] for i in range(4)]
    rough = [half_space.solve(ball - (piece - piece.mean()), load=load).area for piece in pieces]
    pressure = peak * np.sqrt(1 - (np.arange(1000) + 0.5) / 1000)  # at places of equal areas
    share = erf(0.5 * np.sqrt(np.pi) * 2.0 * pressure / (MODULUS * slope)).mean()
    assert np.mean(rough) / smooth == pytest.approx(share, abs=0.05)
