"""Bodies by closed forms, and modes fitted to receptances of wheels, bodies and structures."""

import tracemalloc
import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity import Beam, errors, material
from asperity.errors import InputError, UnconvergedWarning
from asperity.laws import HertzLaw
from asperity.reduction.texture import StateTexture
from asperity.rolling.roll import roll_bodies
from asperity.spectra import psd
from asperity.structures.body import GRAVITY, Body, Wheel, carriage, chain
from asperity.structures.modal_fit import FittedFractions, partial_fractions, vector_fit, warn_of_wide_lines
from asperity.structures.receptance_fit import fit_body, fit_structure, receptances_in
from refusals import refusals

FEW = np.array([0.7, 4.0, 31.0, 250.0])
RATE = 2j * np.pi * FEW
BOGIE = (3000.0, 1800.0, [0.0, 2.5], 600.0, 1.2e6, 8e3)


def two_masses(lower, upper, spring, damper):
    """Receptance at the lower of two masses: −(1/ω²)(…) from Newton's equations, solved by hand."""
    link = spring + damper * RATE
    return (upper * RATE**2 + link) / ((lower * RATE**2 + link) * (upper * RATE**2 + link) - link**2)


def bar_on(places, pressing=(981.0, 0.0)):
    """A rigid bar of 100 kg and 10 kg m², on contacts at places from its centre of mass, m."""
    contacts, none = np.stack([np.ones(len(places)), places], axis=1), np.zeros((2, 2))
    return Body(np.diag([100.0, 10.0]), none, none, contacts, np.array(pressing), np.array(places))


@pytest.mark.parametrize(
    ("body", "loads"),
    [
        (Body.rigid(600.0, 65e3), [65e3]),
        (bar_on([-1.0, 3.0]), [0.75 * 981.0, 0.25 * 981.0]),
        (bar_on([-3.0, -1.0, 1.0, 3.0]), [0.25 * 981.0] * 4),
        (chain([600.0, 1500.0, 8e3], [1.2e6, 0.4e6], [1e4, 2e4], load=1e3), [10100.0 * GRAVITY + 1e3]),
        (carriage(*BOGIE, load=2e3), [2100.0 * GRAVITY + 1e3] * 2),
    ],
)
def test_contacts_carry_weights_and_load_as_levers_share_them(body, loads):
    assert body.static_loads == pytest.approx(loads)


def test_the_modes_of_a_bogie_are_bounce_and_pitch():
    """Both wheels alike lift half of what is above, against one another its pitch: each a chain of masses."""
    rolled = 1800.0 / (2.0 * 1.25**2)  # kg at each wheel
    body = carriage(*BOGIE)
    point, transfer = body.receptance(FEW)[:, 0, 0], body.receptance(FEW)[:, 0, 1]
    assert_allclose(point + transfer, two_masses(600.0, 1500.0, 1.2e6, 8e3), rtol=1e-10)
    assert_allclose(point - transfer, two_masses(600.0, rolled, 1.2e6, 8e3), rtol=1e-10)
    assert body.places.tolist() == [0.0, 2.5]


def test_elements_carry_a_carriage_on_springs():
    body = carriage(2.0, 0.01, [0.0, 0.03, 0.06], 0.05, 40e6, 100.0, load=60.0)
    assert body.static_loads == pytest.approx([(2.0 * GRAVITY + 60.0) / 3.0 + 0.05 * GRAVITY] * 3)
    # all elements alike: a third of the carriage on each
    alike = body.receptance(FEW).sum(axis=2)[:, 1]
    assert_allclose(alike, two_masses(0.05, 2.0 / 3.0, 40e6, 100.0), rtol=1e-9)


def test_each_wheel_has_its_own_modes():
    modes, pair = ([400.0, 2000.0], [0.01, 0.002], [300.0, 100.0]), carriage(*BOGIE)
    ringing = pair.with_modes(*modes)
    added = ringing.receptance(FEW) - pair.receptance(FEW)
    flexible = 0.0
    for f, ratio, mass in zip(*modes, strict=True):
        omega = 2 * np.pi * f
        flexible = flexible + 1.0 / mass / (omega**2 + 2 * ratio * omega * RATE + RATE**2)
    assert_allclose(added[:, 1, 1], flexible, rtol=1e-6)
    assert np.abs(added[:, 0, 1]).max() < 1e-6 * np.abs(flexible).min()
    assert ringing.static_loads == pytest.approx(pair.static_loads)


test_bodies_that_cannot_be_are_refused = refusals(
    (lambda: bar_on([1.0]), r"too few: it falls or tilts.*more contacts"),
    (lambda: bar_on([-1.0, 1.0], [981.0]), r"pressing of a body.*shape \(2,\)"),
    (lambda: Body.rigid(0.0, 1.0), "one without inertia; allowed: positive masses"),
    (lambda: chain([1.0], [], [], load=-20.0), r"a contact under -10.2 N; allowed: contacts that"),
    (lambda: chain([1.0], [], []).receptance(0.0), "no static receptance"),
)


pytestmark = pytest.mark.filterwarnings("ignore:.* modes are narrower")  # of tables without noise


def response(s, poles, residues):
    both = zip(poles, residues, strict=True)
    return sum(r / (s - p) + (np.conj(r) / (s - np.conj(p)) if p.imag else 0.0) for p, r in both)


def test_poles_of_rational_functions_are_found():
    poles = np.array([-20.0, -5.0 + 300.0j, -40.0 + 2000.0j, -10.0 + 2100.0j])
    residues = np.array([[3.0, 1.0 - 2.0j, 4.0j, 0.5], [1.0, 0.2j, -3.0, 2.0 + 1.0j]])
    lines = 2j * np.pi * np.geomspace(1.0, 1000.0, 300)
    start = np.array([-1.0 + 100j, -5.0 + 1000j, -10.0 + 3000j, -100.0])
    found = vector_fit(lines, [response(lines, poles, r) for r in residues], start)
    assert_allclose(found[np.argsort(np.abs(found))], poles, rtol=1e-7)


CIRCLE = np.exp(1j * np.linspace(0.01, 3.0, 200))


def test_what_fractions_leave_of_columns_is_all_that_least_squares_leave():
    random = np.random.default_rng(2)
    poles = np.array([-3.0 + 40.0j, -8.0 + 300.0j, -50.0 + 0.0j])
    points = 1j * np.linspace(1.0, 400.0, 12)
    weight = random.uniform(0.5, 2.0, 12)
    columns = random.normal(size=(24, 3))
    basis = weight[:, None] * partial_fractions(points, poles)
    matrix = np.concatenate([basis.real, basis.imag])
    left = FittedFractions(points, weight, poles).left_of(columns)
    missed = columns - matrix @ np.linalg.lstsq(matrix, columns)[0]
    assert left.shape == (24 - 5, 3)
    assert_allclose(left.T @ left, missed.T @ missed, rtol=1e-9)


def test_all_poles_are_stable_even_for_noise():
    noise = np.random.default_rng(3).normal(size=(2, 3, 200)).T @ [1.0, 1j]
    found = vector_fit(1j * np.linspace(1.0, 100.0, 200), noise.T, -1.0 + 1j * np.linspace(2, 90, 10))
    assert (found.real < 0.0).all()
    for radius in (1.0, 0.9):
        found = vector_fit(CIRCLE, noise.T, 0.8 * np.exp(1j * np.linspace(0.1, 3, 10)), radius=radius)
        assert (np.abs(found) < radius).all()


MASS, LOAD = 600.0, 65e3
FREQUENCIES = np.array([330.0, 1100.0, 1950.0, 2850.0, 3700.0, 4600.0])
RATIOS = np.array([5e-3, 1e-3, 2e-4, 1e-4, 1e-4, 1.5e-4])
MASSES = np.array([900.0, 250.0, 120.0, 80.0, 60.0, 50.0])
WHEEL = Wheel(MASS, LOAD, FREQUENCIES, RATIOS, MASSES)
F = np.arange(20.0, 5001.0, 2.0)
OF_WHEEL = WHEEL.receptance(F)


def test_a_fit_gives_back_the_modes_of_a_wheel():
    body = fit_body(MASS, LOAD, F, OF_WHEEL)
    assert body.fit_error < 1e-3
    assert_allclose(body.natural_frequencies, FREQUENCIES, rtol=1e-6)
    assert_allclose(body.damping_ratios, RATIOS, rtol=1e-3)
    assert_allclose(body.shapes[0] ** -2.0, MASSES, rtol=1e-3)
    assert_allclose(body.receptance(F)[:, 0, 0], OF_WHEEL, rtol=1e-3)
    assert body.static_loads == pytest.approx([LOAD])
    assert_allclose(WHEEL.body.receptance(F)[:, 0, 0], OF_WHEEL, rtol=1e-12)
    rigid = fit_body(MASS, LOAD, F, Wheel(MASS, LOAD).receptance(F))
    assert rigid.natural_frequencies.size == 0
    assert rigid.fit_error < 1e-9


def test_a_fit_to_a_part_of_the_band_keeps_it():
    below = F <= 2400.0
    body = fit_body(MASS, LOAD, F[below], OF_WHEEL[below])
    found = body.receptance(F[below])[:, 0, 0]
    assert_allclose(np.abs(found / OF_WHEEL[below]), 1.0, atol=0.011)  # 0.1 dB
    assert_allclose(body.natural_frequencies[:3], FREQUENCIES[:3], rtol=1e-4)


@pytest.mark.filterwarnings("ignore::asperity.errors.EnergyWarning")
def test_a_fit_to_noise_finds_the_modes_and_takes_energy():
    """2 % of noise in amplitude is 0.17 dB; the fit cannot be nearer, and must not be much farther."""
    noise = 0.02 * np.random.default_rng(1).standard_normal((2, F.size)).T @ [1.0, 1j]
    body = fit_body(MASS, LOAD, F, OF_WHEEL * (1.0 + noise))
    assert 0.15 < body.fit_error < 0.2
    assert np.abs(body.natural_frequencies / FREQUENCIES[:, None] - 1.0).min(axis=1).max() < 1e-4
    assert (body.receptance(np.geomspace(1.0, 50e3, 5000)).imag <= 0.0).all()


STEEL = material("steel")
BEAM = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=37.6e3, loss_factor=0.03)
X = np.linspace(0.0, 1.0, 81)
FORCES = X[[10, 28, 50]]
SHORT = np.arange(10.0, 400.0, 2.0)


def measured(noise=0.0, beam=BEAM, f=SHORT):
    """Receptances of a beam with a relative error of each value, of random phase."""
    values = np.array([[beam.receptance(f, x, force) for force in FORCES] for x in X]).transpose(2, 0, 1)
    real, imaginary = np.random.default_rng(1).standard_normal((2, *values.shape))
    return values * (1.0 + noise * (real + 1j * imaginary) / np.sqrt(2.0))


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
def short():
    return measured()


@pytest.mark.parametrize(("noise", "largest"), [(0.0, 0.1), (0.01, 0.5)])
def test_a_beam_by_its_receptances_has_the_force_of_the_beam(noise, largest):
    f = np.arange(20.0, 8000.0, 20.0)
    found = fit_structure(X, FORCES, f, measured(noise, f=f))
    assert found.fit_error < 0.5
    own = BEAM.natural_frequencies[BEAM.natural_frequencies < f[-1]]
    assert_allclose(found.frequencies[: own.size], own, rtol=2e-3 if noise else 1e-5)
    assert_allclose(found.damping[1 : own.size - 1], 0.015, rtol=0.1 if noise else 0.02)
    assert_allclose(force_levels(found), force_levels(BEAM), rtol=0.0, atol=largest)
    for x in (0.2, 0.31):  # beside a force modes above the band carry on as waves do
        ratio = np.abs(found.receptance(f, x, x + 0.05) / BEAM.receptance(f, x, x + 0.05))
        assert np.median(np.abs(20.0 * np.log10(ratio[f < 7000.0]))) < 0.35


def test_a_fit_takes_energy_at_every_frequency():
    """At any force in any place, also where nothing was measured."""
    f = np.arange(10.0, 2000.0, 10.0)
    found = fit_structure(X, FORCES, f, measured(0.03, f=f))
    beyond, at = np.geomspace(1.0, 50e3, 4000), np.array([0.037, 0.41, 0.77])
    matrix = np.array([[found.receptance(beyond, x, y) for y in at] for x in at]).transpose(2, 0, 1)
    assert np.linalg.eigvalsh(-matrix.imag).min() >= -1e-12 * np.abs(matrix).max()


def test_what_nothing_holds_has_its_rigid_motion():
    """A free beam but for its suspension: mass and inertia given, bending modes found."""
    options = {"support": "free", "suspension_frequency": 0.01, "loss_factor": 0.03}
    free = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=6e3, **options)
    f = np.arange(10.0, 1500.0, 5.0)
    found = fit_structure(X, FORCES, f, measured(0.0, free, f), mass=free.mass, inertia=free.mass / 12.0)
    bending = free.natural_frequencies[2:][free.natural_frequencies[2:] < f[-1]]
    expected = [0.0, 0.0, *bending]
    assert_allclose(found.natural_frequencies[: len(expected)], expected, rtol=1e-4)
    below = f[f < 1000.0]
    for x in (0.31, 0.57):
        error = 20.0 * np.log10(np.abs(found.receptance(below, x, x) / free.receptance(below, x, x)))
        assert np.median(np.abs(error)) < 0.3
        assert np.abs(error[below < 30.0]).max() < 0.01  # the rigid body, below the first mode


def test_receptances_are_gathered_from_lines_in_any_order(short):
    values, places = short[:12], np.meshgrid(SHORT[:12], X, FORCES, indexing="ij")
    rows = np.stack([each.ravel() for each in (*places, values.real, values.imag)], axis=1)
    rows = np.random.default_rng(0).permutation(rows)
    for found, expected in zip(receptances_in(rows, ""), (X, FORCES, SHORT[:12], values), strict=True):
        assert_allclose(found, expected)
    for wrong in (rows[1:], np.concatenate([rows[1:], rows[-1:]])):  # one missing, and another twice
        with pytest.raises(
            InputError, match=r"t.csv: received 291\d lines; allowed: 2916: one for each of 12"
        ):
            receptances_in(wrong, "t.csv")


def test_a_disordered_table_takes_no_more_memory_than_its_lines():
    """Each line another frequency, place and force: all combinations of them would take 2 GB."""
    rows = np.arange(500.0)[:, None] + np.arange(5.0)
    tracemalloc.start()
    with pytest.raises(InputError, match="received 500 lines; allowed: 125000000: one for each of 500 freq"):
        receptances_in(rows, "table.csv")
    assert tracemalloc.get_traced_memory()[1] < 10 * rows.nbytes
    tracemalloc.stop()


def test_doubtful_fits_and_energy_that_is_made_are_warned_of(short):
    bent, wrong = short * np.where(SHORT < 200.0, 1.0, 1.3)[:, None, None], short.copy()
    with pytest.warns(UnconvergedWarning, match=r"\d modes meet the given receptance to \d.\d dB only, more"):
        fit_structure(X, FORCES, SHORT, bent)
    wrong[60:70, 10, 0] = -np.abs(wrong[60:70, 10, 0]) * np.exp(-0.3j)
    said = r"creates energy at 5.1 % of its frequencies, most at 1\d\d Hz"
    with pytest.warns(errors.EnergyWarning, match=said) as seen:
        fit_structure(X, FORCES, SHORT, wrong)
    assert sum(each.category is errors.EnergyWarning for each in seen) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("error", errors.EnergyWarning)
        fit_structure(X, FORCES, SHORT, short)


SLOW = np.arange(20.0, 60.0, 2.0)
ONE = 1.0 / (80.0**2 - SLOW**2 + 0.8j * SLOW)


def test_lines_too_wide_for_a_mode_are_said_with_those_that_hold_it():
    """A mode of 40 Hz with a loss factor of 0.01 is 0.4 Hz wide: lines 2 Hz apart do not hold it."""
    mode, said = (np.array([40.0]), np.array([0.005])), r"1 of 1 modes .* 40 Hz is 0.4 Hz wide, of lines 2 Hz"
    with pytest.warns(errors.CoarseSamplingWarning, match=said) as seen:
        warn_of_wide_lines(SLOW, *mode)
    assert "at most 0.4 Hz apart there" in str(seen[0].message)
    assert seen[0].message.grade is errors.Grade.NOTE
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_wide_lines(np.arange(20.0, 60.0, 0.2), *mode)


def changed(name, change):
    """Fit a structure to a record of which one part is another."""

    def call(short):
        record = {"driven": FORCES, "frequency": SHORT, "receptance": short}
        return fit_structure(X, **(record | {name: change(record[name])}))

    return call


def slow(values, frequency=SLOW):
    places, force = np.array([0.0, 0.3, 1.0]), np.array([0.3])
    return lambda _: fit_structure(places, force, frequency, np.repeat(values[:, None, None], 3, axis=1))


def wheel(change=1.0, frequency=F[:600], receptance=OF_WHEEL[:600], mass=MASS):
    return lambda _: fit_body(mass, LOAD, frequency, change * receptance)


def modes(*lists, mass=MASS, load=LOAD):
    return lambda _: Wheel(mass, load, *lists)


CHANCE = np.random.default_rng(0).uniform(0.01, 1.0, SHORT.size)[:, None, None]


test_records_and_modes_that_are_none_are_refused = pytest.mark.filterwarnings(
    "ignore::asperity.errors.PhysicsWarning"
)(
    refusals(
        (changed("receptance", np.conj), "imaginary part under the forces that is mostly positive"),
        (changed("receptance", lambda h: 0.0 * h), "nothing but zeros at a frequency"),
        (changed("receptance", lambda h: h * CHANCE), "modes meet to .* dB only; .*along the force, not"),
        (changed("driven", lambda x: x + 0.004), r"forces at 0.129, .*different places among those"),
        (slow(1e300 * ONE), "10²⁹[⁶⁷] m/N at 20 to 58 Hz; allowed: 1·10⁻²⁰ to 1·10²⁰ m/N"),
        (
            slow(1e-312 * ONE),
            "at 20 to 58 Hz; allowed: 1·10⁻²⁰ to 1·10²⁰ m/N.* Check the units, and the mass",
        ),
        (slow(ONE, 1e-300 * SLOW), "at 2·10⁻²⁹⁹ to 5.8·10⁻²⁹⁹ Hz; allowed: .* from 1·10⁻⁶ to 1·10²⁰ Hz"),
        (slow(np.full(SLOW.size, -1j)), "values that 1 mode meets to .* dB only"),
        # without a mode left, scipy's non-negative least squares ended the process
        (wheel(np.exp(1e-3j), SLOW, -1e-3 + 0 * SLOW, 1e9), r"modes on a mass of 1e\+09 kg meet to .* dB"),
        (wheel(1e3), r"dB only.*Check the mass, the unit m/N"),
        (wheel(1e-3), r"dB only.*Check the mass, the unit m/N"),
        (wheel(receptance=OF_WHEEL.conj()[:600]), r"receptance: .* mostly positive.*Conjugate"),
        (wheel(frequency=F[:5], receptance=OF_WHEEL[:5]), "5 frequencies; allowed: at least 10"),
        (modes(mass=0.0), "wheel mass"),
        (modes([100.0, 200.0], [0.01], [10.0, 10.0]), "damping ratios of the .*1 number; allowed: 2"),
        (modes([-100.0], [0.01], [10.0]), "natural frequencies of the modes"),
        (modes([100.0], [0.0], [10.0]), "damping ratios of the modes"),
        (lambda _: WHEEL.receptance([0.0, 1.0]), "no static receptance"),
        of=lambda call, short: call(short),
    )
)
