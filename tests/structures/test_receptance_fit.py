"""Structures and bodies by receptances: a beam found again in the force on a ball; noise, energy."""

import re
import tracemalloc
import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.errors import CoarseSamplingWarning, EnergyWarning, Grade, InputError, UnconvergedWarning
from asperity.laws import HertzLaw
from asperity.reduction.texture import StateTexture
from asperity.reference.materials import material
from asperity.rolling.roll import roll_bodies
from asperity.spectra import psd
from asperity.structures.beam import Beam
from asperity.structures.body import Body, carriage
from asperity.structures.modal_fit import warn_of_wide_lines
from asperity.structures.receptance_fit import fit_body, fit_structure, receptances_in
from asperity.structures.wheel import Wheel

pytestmark = pytest.mark.filterwarnings("ignore:.* modes are narrower")  # of tables without noise

STEEL = material("steel")
BEAM = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=37.6e3, loss_factor=0.03)
X = np.linspace(0.0, 1.0, 81)
FORCES = X[[10, 28, 50]]
F = np.arange(20.0, 8000.0, 20.0)


def measured(noise=0.0, beam=BEAM, f=F, forces=FORCES):
    """Receptances of a beam with a relative error of each value, of random phase."""
    given = np.array([[beam.receptance(f, x, force) for force in forces] for x in X]).transpose(2, 0, 1)
    real, imaginary = np.random.default_rng(1).standard_normal((2, *given.shape))
    return given * (1.0 + noise * (real + 1j * imaginary) / np.sqrt(2.0))


def force_levels(structure):
    """Levels of the contact force of a ball on a rough path, one-third octaves from 125 Hz to 5 kHz."""
    steps = np.random.default_rng(2).standard_normal(26_000)
    heights = np.convolve(steps, np.hanning(25), mode="same")
    texture = StateTexture.unfiltered(0.03e-6 * heights / heights.std(), 2e-5, 0.0)
    options = {"speed": 2.0, "start": 0.2, "duration": 0.12, "time_step": 5e-6, "positions": [0.0]}
    law = HertzLaw(2.4e10, texture)
    force = roll_bodies(structure, [Body.rigid(0.514, 30.0)], [law], **options).contact_force[0]
    assert force.min() > 0.0
    lines, density = psd(force, 5e-6)
    centres = 1000.0 * 10.0 ** (np.arange(-9, 8) / 10.0)  # below, where little is, the start of a mode shows
    inside = [(lines >= f * 10**-0.05) & (lines < f * 10**0.05) for f in centres]
    return np.array([10.0 * np.log10(density[band].sum()) for band in inside])


@pytest.fixture(scope="module")
def levels():
    return force_levels(BEAM)


@pytest.mark.parametrize(("noise", "largest"), [(0.0, 0.1), (0.01, 0.5)])
def test_a_beam_by_its_receptances_has_the_force_of_the_beam(levels, noise, largest):
    found = fit_structure(X, FORCES, F, measured(noise))
    assert found.fit_error < 0.5
    own = BEAM.natural_frequencies[BEAM.natural_frequencies < F[-1]]
    assert_allclose(found.frequencies[: own.size], own, rtol=2e-3 if noise else 1e-5)
    ratios = found.damping[1 : own.size - 1]
    assert_allclose(ratios, BEAM.damping_ratio, rtol=0.1 if noise else 0.02)
    assert_allclose(force_levels(found), levels, rtol=0.0, atol=largest)


def test_a_fit_takes_energy_at_every_frequency():
    """At any force in any place, also where nothing was measured."""
    short = np.arange(10.0, 2000.0, 10.0)
    found = fit_structure(X, FORCES, short, measured(0.03, f=short))
    beyond = np.geomspace(1.0, 50e3, 4000)
    at = np.array([0.037, 0.41, 0.77])
    matrix = np.array([[found.receptance(beyond, x, y) for y in at] for x in at]).transpose(2, 0, 1)
    assert np.linalg.eigvalsh(-matrix.imag).min() >= -1e-12 * np.abs(matrix).max()


def test_what_nothing_holds_has_its_rigid_motion():
    """A free beam but for its suspension: mass and inertia given, bending modes found."""
    free = Beam.rectangular(
        1.0,
        0.05,
        0.01,
        STEEL,
        support="free",
        highest_frequency=6e3,
        suspension_frequency=0.01,
        loss_factor=0.03,
    )
    f = np.arange(10.0, 1500.0, 5.0)
    given = measured(beam=free, f=f)
    found = fit_structure(X, FORCES, f, given, mass=free.mass, inertia=free.mass / 12.0)
    assert found.natural_frequencies[:2].tolist() == [0.0, 0.0]
    bending = free.natural_frequencies[2:]
    bending = bending[bending < f[-1]]
    assert_allclose(found.natural_frequencies[2 : 2 + bending.size], bending, rtol=1e-4)
    below = f[f < 1000.0]
    for x in (0.31, 0.57):
        error = 20.0 * np.log10(np.abs(found.receptance(below, x, x) / free.receptance(below, x, x)))
        assert np.median(np.abs(error)) < 0.3
        assert np.abs(error[below < 30.0]).max() < 0.01  # the rigid body, below the first mode


def test_a_wheel_by_its_receptance_is_a_body():
    wheel = Wheel.from_modes(600.0, 65e3, [400.0, 2000.0], [0.01, 0.002], [300.0, 100.0])
    f = np.arange(20.0, 3000.0, 2.0)
    body = fit_body(600.0, 65e3, f, wheel.receptance(f))
    assert_allclose(body.receptance(f)[:, 0, 0], wheel.receptance(f), rtol=1e-3)
    assert body.static_loads == pytest.approx([65e3])
    assert body.fit_error < 0.01


def test_a_body_on_two_contacts_by_its_receptances():
    """A carriage with one mode that moves its ends alike, and one that moves them against one another."""
    rigid = carriage(3.0, 0.02, [0.0, 0.1], load=200.0)
    f = np.arange(20.0, 3000.0, 2.0)
    shapes = np.array([[0.6, 0.5], [0.6, -0.5]])
    omega, own = 2 * np.pi * f[:, None], 2 * np.pi * np.array([700.0, 1900.0])
    answers = 1.0 / (own**2 - omega**2 + 2j * 0.01 * own * omega)
    given = rigid.receptance(f) + np.einsum("nr,ir,jr->nij", answers, shapes, shapes)
    load = 3.0 * 9.80665 + 200.0
    body = fit_body(3.0, load, f, given, places=[0.0, 0.1], inertia=0.02)
    assert_allclose(body.receptance(f), given, rtol=1e-4, atol=1e-6 * np.abs(given).min())
    assert body.static_loads == pytest.approx([0.5 * load] * 2)
    with pytest.raises(InputError, match=r"moment of inertia .*one, of a body on several contacts"):
        fit_body(3.0, load, f, given, places=[0.0, 0.1])


SHORT = np.arange(10.0, 400.0, 2.0)


@pytest.fixture(scope="module")
def short():
    return measured(f=SHORT)


def test_energy_that_is_made_is_warned_of_with_its_frequency(short):
    wrong = short.copy()
    wrong[60:70, 10, 0] = -np.abs(wrong[60:70, 10, 0]) * np.exp(-0.3j)
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        fit_structure(X, FORCES, SHORT, wrong)
    said = [str(each.message) for each in seen if each.category is EnergyWarning]
    assert len(said) == 1
    assert re.search(r"creates energy at 5.1 % of its frequencies, most at 1\d\d Hz", said[0])
    with warnings.catch_warnings():
        warnings.simplefilter("error", EnergyWarning)
        fit_structure(X, FORCES, SHORT, short)


def test_a_doubtful_fit_is_warned_of(short):
    bent = short * np.where(SHORT < 200.0, 1.0, 1.3)[:, None, None]
    with pytest.warns(UnconvergedWarning, match=r"modes meet the given receptances to \d.\d dB only"):
        fit_structure(X, FORCES, SHORT, bent)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"receptance": lambda h: h.conj()}, "imaginary part under the forces that is mostly positive"),
        ({"receptance": lambda h: h[:, :5]}, r"shapes \(195,\) and \(195, 5, 3\)"),
        ({"receptance": lambda h: h * np.nan}, "values that are not finite"),
        ({"receptance": lambda h: 0.0 * h}, "nothing but zeros at a frequency"),
        ({"frequency": lambda f: f[::-1]}, "frequencies in disorder"),
        (
            {"frequency": lambda f: f[:5], "receptance": lambda h: h[:5]},
            "5 frequencies; allowed: at least 10",
        ),
        ({"driven": lambda x: x + 0.004}, r"forces at 0.129, .*different places among those"),
    ],
)
def test_records_that_are_none_are_refused(short, change, message):
    given = {"driven": FORCES, "frequency": SHORT, "receptance": short}
    changed = {name: change.get(name, lambda value: value)(value) for name, value in given.items()}
    with pytest.raises(InputError, match=message):
        fit_structure(X, **changed)


def test_what_modes_cannot_meet_is_refused(short):
    """Levels of no structure: up and down from frequency to frequency."""
    chance = np.random.default_rng(0).uniform(0.01, 1.0, SHORT.size)[:, None, None]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises(InputError, match=r"modes meet to .* dB only; .*Check that it is m/N"):
            fit_structure(X, FORCES, SHORT, short * chance)


def test_receptances_are_gathered_from_lines(short):
    rows = [
        [f, x, force, short[i, j, k].real, short[i, j, k].imag]
        for k, force in enumerate(FORCES)
        for i, f in enumerate(SHORT[:12])
        for j, x in enumerate(X)
    ]
    rows = np.random.default_rng(0).permutation(np.array(rows))
    at, forces, f, given = receptances_in(rows, "table.csv")
    assert_allclose(at, X)
    assert_allclose(forces, FORCES)
    assert_allclose(f, SHORT[:12])
    assert_allclose(given, short[:12])
    with pytest.raises(
        InputError, match=r"table.csv: received 2915 lines; allowed: 2916: one for each of 12"
    ):
        receptances_in(rows[1:], "table.csv")
    with pytest.raises(InputError, match=r"lines; allowed: .*one for each of"):  # one twice, and one missing
        receptances_in(np.concatenate([rows[1:], rows[-1:]]), "table.csv")


def test_a_disordered_table_takes_no_more_memory_than_its_lines():
    """Each line another frequency, place and force: all combinations of them would take 2 GB."""
    rows = np.arange(500.0)[:, None] + np.arange(5.0)
    tracemalloc.start()
    with pytest.raises(InputError, match="received 500 lines; allowed: 125000000: one for each of 500 freq"):
        receptances_in(rows, "table.csv")
    assert tracemalloc.get_traced_memory()[1] < 10 * rows.nbytes
    tracemalloc.stop()


SLOW = np.arange(20.0, 60.0, 2.0)
ONE = 1.0 / (80.0**2 - SLOW**2 + 0.8j * SLOW)


@pytest.mark.parametrize(
    ("frequency", "values", "message"),
    [
        (SLOW, 1e300 * ONE, "e.29[67] m/N at 20 to 58 Hz; allowed: 1e-20 to 1e.20 m/N"),
        (
            SLOW,
            1e-312 * ONE,
            "m/N at 20 to 58 Hz; allowed: 1e-20 to 1e.20 m/N.* Check the units, and the mass",
        ),
        (1e-300 * SLOW, ONE, "at 2e-299 to 5.8e-299 Hz; allowed: .* from 1e-06 to 1e.20 Hz"),
        (SLOW, np.full(SLOW.size, -1j), "values that 1 modes meet to .* dB only"),
    ],
)
def test_what_no_modes_can_meet_is_said(frequency, values, message):
    with pytest.raises(InputError, match=message):
        fit_structure([0.0, 0.3, 1.0], [0.3], frequency, np.repeat(values[:, None], 3, axis=1))


def test_a_body_that_no_mode_fits_is_refused():
    """Without a mode left, scipy's non-negative least squares ended the process."""
    with pytest.raises(InputError, match=r"modes on a mass of 1e\+09 kg meet to .* dB only"):
        fit_body(1e9, 10.0, SLOW, np.full(SLOW.size, -1e-3 * np.exp(1e-3j)))


def test_lines_too_wide_for_a_mode_are_said_with_those_that_hold_it():
    """A mode of 40 Hz with a loss factor of 0.01 is 0.4 Hz wide: lines 2 Hz apart do not hold it."""
    with pytest.warns(
        CoarseSamplingWarning, match=r"1 of 1 modes .* 40 Hz is 0.4 Hz wide, of lines 2 Hz"
    ) as told:
        warn_of_wide_lines(SLOW, np.array([40.0]), np.array([0.005]))
    assert "at most 0.4 Hz apart there" in str(told[0].message)
    assert told[0].message.grade is Grade.NOTE
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_wide_lines(np.arange(20.0, 60.0, 0.2), np.array([40.0]), np.array([0.005]))
