"""State functions of tangential contact: Mindlin's and Kalker's closed forms, and bounds on any contact."""

import math

import numpy as np
import pytest

from asperity import HalfSpace, Hertz, Material
from asperity.contact.creep import kalker_coefficients
from asperity.contact.hertz import stick_stiffness
from asperity.errors import OutOfRangeWarning, TruncatedContactWarning
from asperity.reduction.traction import traction_states
from asperity.surfaces.synthesis import self_affine
from refusals import refusals

RADIUS, APPROACH = 0.02, 1e-6


def like(nu):
    return (Material("like", 200e9, nu, 7800.0),) * 2


def smooth(n, nu=0.3, ratio=1.0, scale=1.1):
    """Half-space and gap of a smooth contact at the approach on n cells, and its semi-axes."""
    modulus = 0.5 * 200e9 / (1.0 - nu**2)
    hertz = Hertz(modulus, RADIUS, ratio * RADIUS)
    axes = hertz.semi_axes(APPROACH)
    spacing = tuple(2.0 * scale * a / n for a in axes)
    x, y = (d * (np.arange(n) - 0.5 * (n - 1)) for d in spacing)
    return HalfSpace((n, n), spacing, modulus), np.add.outer(x**2, y**2 / ratio) / (2.0 * RADIUS), axes


@pytest.mark.parametrize(("nu", "ratio"), [(0.3, 1.0), (0.5, 1.0), (0.3, 4.0)])
def test_a_smooth_contact_has_mindlins_stiffness(nu, ratio):
    """Of a circle 2(1 − ν)/(2 − ν) of the normal one; of an ellipse by Mindlin's integrals."""
    for n, precise in ((16, 0.06), (64, 0.012)):
        space, gap, (a, b) = smooth(n, nu, ratio)
        found = traction_states(space, like(nu), gap, [np.zeros_like(gap)], [APPROACH])
        (matrix, same), (normal, _) = found.tangential[:, 0, 0], found.normal[:, 0, 0]
        expected = [stick_stiffness((b, a), like(nu)), stick_stiffness((a, b), like(nu))]
        assert np.diag(matrix) == pytest.approx(expected, rel=precise)
        assert matrix == pytest.approx(same, rel=1e-4, abs=1e-6 * normal)
        over = np.array(expected) / Hertz(space.modulus, RADIUS, ratio * RADIUS).tangent_stiffness(APPROACH)
        if n == 64:
            assert found.area[:, 0, 0] == pytest.approx(np.pi * a * b, rel=0.005)  # 0.8 % more by cells
        near = (0.05 if ratio == 1.0 else 0.2) * precise
        assert np.diag(matrix) / normal == pytest.approx(over, rel=near)


def test_a_smooth_contact_has_kalkers_coefficients():
    found = []
    for n in (24, 48):
        space, gap, (a, b) = smooth(n, ratio=2.0)
        states = traction_states(space, like(0.3), gap, [np.zeros((5 * n, n))], [APPROACH])
        assert states.change["lateral creep"][0] == pytest.approx(1.0, abs=2e-3)
        shear, c = 0.5 * 200e9 / 1.3, math.sqrt(states.area[1, 0, 0] / math.pi)
        found.append(states.creep[1, 0, 0] / (shear * c**2 * np.array((1.0, 1.0, c))))
    expected = np.array(kalker_coefficients(a / b, 0.3))
    assert 2.0 * found[1] - found[0] == pytest.approx(expected, rel=0.02)
    assert (np.abs(found[1] / expected - 1.0) < 0.6 * np.abs(found[0] / expected - 1.0) + 2e-3).all()


def rough(space, rows, seed, rms=0.1 * APPROACH):
    keys = {"hurst": 0.8, "longest": 16 * space.spacing[0], "shortest": 4 * space.spacing[0]}
    return self_affine((rows, space.shape[1]), space.spacing, rms=rms, seed=seed, **keys).heights


@pytest.fixture(scope="module")
def ensemble():
    space, gap, _ = smooth(45, scale=1.55)
    samples = [rough(space, 170, seed) for seed in (1, 2, 3)]
    return space, gap, samples, traction_states(space, like(0.3), gap, samples, [0.2e-6, 0.5e-6, 1.2e-6])


def test_rough_contacts_are_between_the_bounds(ensemble):
    """On any area (1 − ν) k_n ≤ k_t ≤ k_n, and the harmonic mean no less than Mindlin's share."""
    *_, found = ensemble
    ratio, mindlin = found.tangential / found.normal[..., None, None], 1.4 / 1.7
    assert ratio[..., 0, 1] == pytest.approx(ratio[..., 1, 0], abs=1e-5)
    values = np.linalg.eigvalsh(ratio)
    assert values.min() > 0.7
    assert values.max() < 1.0
    mean = 2.0 / (1.0 / ratio[..., 0, 0] + 1.0 / ratio[..., 1, 1])
    assert mean.min() > mindlin * (1.0 - 1e-6)
    assert mean.max() < 1.01 * mindlin


def test_without_poissons_ratio_both_stiffnesses_are_one(ensemble):
    space, gap, samples, _ = ensemble
    space = HalfSpace(space.shape, space.spacing, 100e9)
    found = traction_states(space, like(0.0), gap, [sample[:45] for sample in samples], [0.3e-6, 1e-6])
    expected = found.normal[..., None, None] * np.eye(2)
    assert found.tangential == pytest.approx(expected, abs=1e-5 * found.normal.min())
    assert np.isnan(found.creep).all()  # no room to roll


def test_under_load_the_rough_contact_becomes_the_smooth_one(ensemble):
    *_, found = ensemble
    assert found.load.shape == (3, 3)
    for name in ("normal stiffness", "stiffness across", "longitudinal creep"):
        mean, scatter = found.change[name]
        assert mean[0] < mean[2]
        assert abs(mean[2] - 1.0) < 0.03
        assert (scatter < 0.1).all()
    assert (found.change["real area"][0] < 0.9).all()
    rough_creep, smooth_creep = found.creep[:, :, 1, 0]
    assert found.change["longitudinal creep"][0][1] == pytest.approx(np.mean(rough_creep / smooth_creep))


def test_what_is_left_out_is_told():
    space, gap, _ = smooth(12)
    soft = Material("soft", 1.0 / (1.0 / space.modulus - 0.96 / 300e9), 0.0, 1.0)
    with pytest.warns(OutOfRangeWarning, match="The bodies are unlike"):
        traction_states(space, (Material("hard", 300e9, 0.2, 1.0), soft), gap, [0.0 * gap], [APPROACH])
    with pytest.warns(TruncatedContactWarning, match="end the approaches lower"):
        traction_states(space, like(0.3), gap, [0.0 * gap], [4.0 * APPROACH])


def asked(sample, approaches):
    space, gap, _ = smooth(12)
    return traction_states(space, like(0.3), gap, sample, approaches)


test_what_has_no_states_is_refused = refusals(
    ([np.zeros((12, 12))], [1e-6, 5e-7], "approaches: received numbers that do not rise"),
    ([np.full((12, 12), -1e-5)], [1e-6], r"approaches: received 1e-06 m; allowed: above 1.0\d*e-05 m, where"),
    ([np.zeros((11, 12))], [1e-6], "samples: received 1 of 11 rows at least; allowed: arrays of"),
    ([], [1e-6], "samples: received 0 of 0 rows"),
    ([np.full((12, 12), np.nan)], [1e-6], "sample: received nan; allowed: arrays of finite"),
    ([np.zeros((12, 9))], [1e-6], r"sample: received shape \(12, 9\)"),
    of=asked,
)
