"""What moves sideways in a run: nothing in the middle; off it by the formulas, at every place of a bay."""

import math

import numpy as np
import pytest

from asperity.case.bodies import Bodies, WheelOnRail
from asperity.contact.hertz import stick_stiffness
from asperity.radiation.track import SideOfRail, squared_lateral_mobility
from asperity.radiation.wheel import RadiatingWheel
from asperity.reference.materials import MATERIALS
from asperity.reporting.data import unless_missing
from asperity.scenes import schema
from asperity.scenes.beside_track import pass_by_group
from asperity.scenes.figures import noise
from asperity.scenes.figures.measured import limits_table
from asperity.scenes.figures.sideways import SIDEWAYS, sideways_table
from asperity.spectra import HALF_BAND, band_energies, energy_sum
from asperity.structures.lateral_rail import LateralTrack, wheel_receptances
from asperity.structures.modal import modal_answers
from asperity.surfaces.heightmap import Profile
from small_cases import HEARD

CASE = HEARD | {"duration": "0.3 s"}
PLACE = 0.01
STEEL = MATERIALS["steel"]
LEANING, HEAD = {"rail_inclination": "1:40", "wheel_shift": "5 mm"}, 0.3 * math.sin(math.atan(1 / 40))
RINGING = {"roughness": "disc", "section": "straight-web"}


@pytest.fixture
def off(runs):
    return runs(WheelOnRail(**CASE | {"sideways": {"contact_place": PLACE}}))


def test_nothing_moves_sideways_under_a_rigid_wheel_in_the_middle(runs):
    tree = runs(WheelOnRail(**CASE))
    assert "sideways" not in tree.children
    assert unless_missing(sideways_table, tree) is None


def by_places(case, frequency, modes=None, head=PLACE):
    """At 12 places of a bay: lateral over vertical force (n, f), and how the latter is spread there."""
    track, vertical, hertz = LateralTrack(case.track.model()), case.track.model(), case.smooth_contact
    under = hertz.approach(65e3)
    springs = (
        hertz.tangent_stiffness(under),
        stick_stiffness(hertz.semi_axes(under), (STEEL,) * 2),
    )
    wheel, places = wheel_receptances(modes, 600.0, frequency, PLACE), (np.arange(12) + 0.5) * 0.05
    rail = wheel[:, :, None] + track.answers(2.0 * np.pi * frequency, places, places, head)
    up = vertical.receptance(frequency, places, places)
    squares = np.abs(wheel[0, 0] + 1.0 / springs[0] + up) ** -2
    return places, -rail[1, 0] / (rail[1, 1] + 1.0 / springs[1]), squares / np.mean(squares, axis=0)


def of_part(spectra, name):
    return spectra["radiated_power_level"].sel(radiator=name).values[0]


def assert_levels(found, frequency, density, band, low=180.0):
    inside = (band > low) & (band < 3500.0)
    expected = 10.0 * np.log10(band_energies(frequency, density, band / HALF_BAND, band * HALF_BAND))
    np.testing.assert_allclose(found[inside], expected[inside], atol=0.15)


@pytest.mark.parametrize("way", [{"contact_place": PLACE}, LEANING])
def test_the_lateral_force_and_the_rail_are_those_of_both_forces_at_every_place(runs, way):
    """T/F = −α_lv/(α_ll + 1/k_T), and the power of (F, T) as the vertical force is spread over the bay."""
    case, head = (
        WheelOnRail(**CASE | {"sideways": way}).with_(**{"contact.friction": 0.01}),
        way.get("contact_place", HEAD),
    )
    side, spectra = runs(case)["sideways"], runs(case)["spectra"]
    frequency, force, band = (spectra[name].values for name in ("frequency", "force_psd", "band"))
    places, share, spread = by_places(case, frequency, head=head)
    lateral = np.mean(spread * np.abs(share) ** 2, axis=0) * force[0]
    assert_levels(side["lateral_force_level"].values[0], frequency, lateral, band)
    both, track = np.stack([np.ones_like(share), share], axis=1), LateralTrack(case.track.model())
    forms = squared_lateral_mobility(track, frequency, places, head)
    moved = np.mean(spread * np.einsum("xmf,xmnf,xnf->xf", both.conj(), forms, both).real, axis=0)
    power = 2.0 * SideOfRail(0.172, 0.15, 0.072).power(frequency, moved * force[0]) / 1e-12
    assert_levels(of_part(spectra, "rail sideways"), frequency, power, band)


def test_what_the_lateral_force_does_to_the_vertical_one_is_told_with_its_sign(off):
    """|1/(A_vv − A_vl²/A_ll)|² against |1/A_vv|², each as a mean over the bay, in bands."""
    case = WheelOnRail(**CASE)
    frequency, band = (off["spectra"][name].values for name in ("frequency", "band"))
    under = case.smooth_contact.approach(65e3)
    normal = case.smooth_contact.tangent_stiffness(under)
    tangential = stick_stiffness(case.smooth_contact.semi_axes(under), (STEEL,) * 2)
    track = LateralTrack(case.track.model())
    wheel = wheel_receptances(None, 600.0, frequency, PLACE)
    places = (np.arange(12) + 0.5) * 0.05
    (vv, vl), (_, ll) = wheel[:, :, None] + track.answers(2.0 * np.pi * frequency, places, places, PLACE)
    vv = vv + 1.0 / normal
    energy = (np.abs([1.0 / (vv - vl**2 / (ll + 1.0 / tangential)), 1.0 / vv]) ** 2).sum(axis=1)
    coupled, free = (band_energies(frequency, each, band / HALF_BAND, band * HALF_BAND) for each in energy)
    found, expected = off["sideways"]["vertical_force_change"].values, 10.0 * np.log10(coupled / free)
    inside = (band > 180.0) & (band < 3500.0)
    np.testing.assert_allclose(found[inside], expected[inside], atol=0.02)
    assert np.abs(expected[inside]).max() > 0.1


def test_modes_of_the_wheel_follow_both_forces(runs):
    """ω²|A (φ_r + φ_a T/F)|² S_F of modes so damped that no line hides a resonance."""
    case = WheelOnRail(
        **CASE | {"wheel": RINGING | {"modal_damping": [0.05]}, "sideways": {"contact_place": PLACE}}
    )
    tree, modes = runs(case), case.wheel.turning_modes(4000.0, 56.0)
    frequency, force, band = (tree["spectra"][name].values for name in ("frequency", "force_psd", "band"))
    _, share, spread = by_places(case, frequency, modes)
    omega, shapes = 2.0 * np.pi * frequency, np.append(np.eye(2), modes.at(PLACE), axis=1)  # rigid ones first
    answers = modal_answers(frequency, modes.natural_frequencies, modes.damping_ratios).T
    answers = omega * np.vstack([np.tile(1.0 / (600.0 * omega**2), (2, 1)), answers])
    moved = np.mean(spread * np.abs(shapes[0, :, None, None] + shapes[1, :, None, None] * share) ** 2, axis=1)
    parts = ([1, 0], modes.nodal_diameters), ([0.0, 1.0], modes.disc), ([math.sqrt(0.5), 0.0], modes.tread)
    wheel = RadiatingWheel(0.46, 0.135, *(np.append(*each) for each in parts))
    power = 2.0 * wheel.power(frequency, np.abs(answers) ** 2 * moved).sum(axis=0) * force[0] / 1e-12
    assert_levels(of_part(tree["spectra"], "wheel"), frequency, power, band, 350.0)
    pushed = np.mean(spread * np.abs(shapes[1, :, None, None] * share) ** 2, axis=1)
    power = 2.0 * wheel.power(frequency, np.abs(answers) ** 2 * pushed).sum(axis=0) * force[0] / 1e-12
    alone = tree["spectra"]["single_force_power_level"].values[0, 1]
    assert_levels(alone, frequency, power, band, 350.0)
    low = (band > 70.0) & (band < 110.0)  # where most of it is the rigid motion along the axle
    expected = 10.0 * np.log10(band_energies(frequency, power, band / HALF_BAND, band * HALF_BAND))
    np.testing.assert_allclose(alone[low], expected[low], atol=0.4)


def test_twice_as_far_off_on_the_other_side_it_is_twice_as_much_and_slips_on_ice(runs, off):
    """6 dB in force and sound; beyond friction by a normal distribution of the lateral force."""
    way = {"contact_place": -2.0 * PLACE}
    tree = runs(WheelOnRail(**CASE | {"sideways": way}).with_(**{"contact.friction": 0.01}))
    near, far, spectra, twice = off["sideways"], tree["sideways"], tree["spectra"], 20.0 * math.log10(2.0)
    change = far["lateral_force_level"] - near["lateral_force_level"]
    np.testing.assert_allclose(change, twice, atol=1e-6)
    power = [each["spectra/radiated_power_level_a"] for each in (tree, off)]
    louder = (power[0] - power[1]).sel(radiator="rail sideways")
    assert float(louder[0]) == pytest.approx(twice, abs=1e-6)
    density, step = spectra["lateral_force_psd"].values[0], np.diff(spectra["frequency"].values)[0]
    rms = float(far["lateral_force_rms"][0])
    assert rms == pytest.approx(math.sqrt(density.sum() * step), rel=1e-3)
    assert float(far["slip_share"][0]) == pytest.approx(
        math.erfc(0.01 * 65e3 / math.sqrt(2.0) / rms), rel=1e-9
    )
    assert (far.attrs["contact_place"], far.attrs["slip_force"]) == (-0.02, pytest.approx(650.0))


def ringing(runs, place):
    return runs(WheelOnRail(**CASE | {"wheel": RINGING, "sideways": {"contact_place": place}}))


def test_the_chapter_says_where_how_loud_and_whether_it_slips(runs, off):
    for tree in (off, ringing(runs, PLACE)):
        for figure in SIDEWAYS:
            assert figure.drawn(tree).chart.panels
        said = SIDEWAYS[0].drawn(tree).caption
        assert "10 mm off the middle" in said
        assert "(Mindlin)" in said
        table = sideways_table(tree)
        row = dict(zip(table.head, (cell.text for cell in table.rows[0]), strict=True))
        assert row["law"] == "linear"
        assert row["beyond friction"] == "0.0 %"


def test_tread_and_head_answer_each_at_its_own_place(runs):
    """A flat tread on a head that leans: R sin(1:40) to the field side, on the tread less the shift."""
    case = WheelOnRail(**CASE | {"wheel": RINGING, "sideways": LEANING})
    side = runs(case)["sideways"]
    assert side.attrs["rail_contact_place"] == pytest.approx(HEAD, rel=1e-6)
    assert side.attrs["contact_place"] == pytest.approx(HEAD - 0.005, rel=1e-5)
    at, modes = side["frequency"].values, case.wheel.turning_modes(4000.0, 56.0)
    rail = LateralTrack(case.track.model()).answers(2.0 * np.pi * at, 0.3, 0.3, HEAD)
    wheel = wheel_receptances(modes, 600.0, at, side.attrs["contact_place"])
    for name, expected in (("rail", rail), ("wheel", wheel)):
        found = side[f"{name}_cross_receptance"].values
        np.testing.assert_allclose(found, np.abs(expected[1, 0]), rtol=1e-5)


TRAIN = {"vehicle_length": "26 m", "axle_positions": ["0 m", "2.5 m", "19 m"], "vehicle": "coach"}


@pytest.fixture
def passing(runs):
    case = WheelOnRail(**CASE | {"wheel": RINGING, "sideways": {"contact_place": PLACE}, "noise": TRAIN})
    return case, runs(case)


def test_the_total_is_that_of_all_motion_and_what_one_force_alone_would_make_stands_beside_it(passing):
    """Under both forces, the wheel's power is neither that of one nor of both apart."""
    _, tree = passing
    held = tree["spectra"]
    assert held["radiator"].values.tolist() == ["rail", "rail sideways", "sleepers", "wheel", "total"]
    sent, alone = held["radiated_power_level"].values[0], held["single_force_power_level"].values[0]
    np.testing.assert_allclose(sent[4], energy_sum(sent[:4], axis=0), atol=1e-9)
    np.testing.assert_allclose(alone[2], energy_sum([sent[0], sent[2], alone[0]], axis=0), atol=1e-9)
    apart = energy_sum(alone[:2], axis=0)
    assert (np.abs(apart - sent[3]) > 0.5).any()


def test_parts_of_one_place_are_heard_by_their_power_alone(passing):
    """From the same height at the same place the exposure of two parts differs by their power alone."""
    _, tree = passing
    found = tree["pass_by"]
    assert found["radiator"].values.tolist() == tree["spectra"]["radiator"].values.tolist()
    sent, heard = tree["spectra"]["radiated_power_level"].values[0], found["sound_exposure_level"].values[0]
    np.testing.assert_allclose(heard[1] - heard[0], sent[1] - sent[0], atol=1e-9)
    np.testing.assert_allclose(heard[4], energy_sum(heard[:4], axis=0), atol=1e-9)


@pytest.mark.parametrize(("rate", "least"), [(8.0, 1.0), (1e-3, 8.0)])
def test_with_the_same_power_and_decay_the_rail_is_heard_as_up_and_down(passing, rate, least):
    """And waves run no farther than those up and down, of which the record holds the whole."""
    case, up = passing[0], passing[1]["spectra"].to_dataset().copy(deep=True)
    up["band_decay_rate"][:], up["band_decay_rate"][0], up["radiated_power_level"][..., 0] = (
        8.0,
        least,
        np.nan,
    )
    up["radiated_power_level"][:, 1] = up["radiated_power_level"][:, 0]
    edge = math.sqrt(up["band"][0] * up["band"][1]) * np.array([1.0 - 1e-9, 1.0 + 1e-9])
    beside = {schema.SIDEWAYS_FREQUENCY: edge, schema.LATERAL_DECAY_RATE: np.minimum(rate, [least, rate])}
    level = pass_by_group(case, up, beside)[schema.PASS_BY_LEVEL][0]
    np.testing.assert_allclose(level[1], level[0], rtol=1e-12)


def test_what_is_said_first_is_the_total_and_its_parts_beneath_it(passing):
    _, tree = passing
    sent, heard = tree["spectra"]["radiated_power_level_a"].values[0], tree["pass_by"]
    alone = tree["spectra"]["single_force_power_level_a"].values[0]
    level = heard["transit_exposure_level"].values[0]
    said, beside = noise.noise_answers(tree), noise.pass_by_answers(tree)
    for (card, *_), each in ((said.numbers, sent), (beside.numbers, level)):
        assert card.value == f"{each[-1]:.1f} dB(A)"
        parts = zip(("rail", "rail sideways", "sleepers", "wheel"), each, strict=False)
        assert ", ".join(f"{name} {part:.1f}" for name, part in parts) in card.note
    assert f"vertical motion alone {alone[2]:.1f} dB(A)" in said.numbers[0].note
    assert f" of {sent[4]:.1f} dB(A) of sound power" in said.lead
    rail, lateral, sleepers, wheel, whole = heard["normalised_level"].values[0].round(1)
    parts = f"rail {rail}, rail sideways {lateral}, sleepers {sleepers}, wheel {wheel}"
    assert limits_table(tree).rows[0][1].text == f"{whole} dB(A): {parts}"
    table = noise.sound_power_table(tree)
    row = {head: cell.text for head, cell in zip(table.head, table.rows[0], strict=True)}
    names = ("rail", "rail sideways", "sleepers", "wheel", "total")
    assert [row[name] for name in names] == [f"{each:.1f}" for each in sent]
    assert "is no part of it" in table.note
    table = sideways_table(tree)
    row = {head: cell.text for head, cell in zip(table.head, table.rows[0], strict=True)}
    assert [row[f"{name} / dB(A)"] for name in schema.SINGLE_FORCES] == [f"{each:.1f}" for each in alone]
    for figure in (noise.radiated_power_bands, noise.pass_by_level):
        assert "rail sideways" in str(figure.drawn(tree).chart)


ONE = {"radius": 0.46, "mass": 600.0, "load": 65e3, "transverse_radius": "inf", "section": "straight-web"}
STEP = 1.5e-3 / 56.0
BOGIE = {"type": "bogie", "masses": [3000.0], "springs": [1.2e6], "dampers": [2e4], "distance": 30.0}


def bodies(body, surface):
    over = {name: each for name, each in HEARD.items() if name != "wheel"} | {"speed": 56.0, "start": "20 m"}
    own = {"body": body, "surface": surface, "sideways": {"contact_place": PLACE}, "duration": "0.1 s"}
    return Bodies(**over | own | {"over": "track", "numerics": HEARD["numerics"] | {"time_step": STEP}})


def test_a_bogie_on_two_equal_wheels_far_apart_is_twice_as_loud_as_one(runs):
    """Both roll over the same line, 3 m long; a frame that moves is felt below 500 Hz."""
    heights = 2e-6 * np.random.default_rng(3).normal(size=3000)
    line = {"line": Profile(heights, 1e-3), "continuation": "repeat"}
    one, two = (runs(bodies(ONE | more, line)) for more in ({}, BOGIE))
    power = [
        each["spectra/radiated_power_level"].sel(radiator=["rail sideways", "wheel"]) for each in (one, two)
    ]
    change = power[1] - power[0]
    louder, twice = change.values[0][:, change["band"] > 500.0], 10.0 * math.log10(2.0)
    np.testing.assert_allclose(louder, twice, atol=0.02)
    alone, both = (each["sideways"] for each in (one, two))
    for rms in (both["lateral_force_rms"], both["lateral_contact_force_rms"]):  # the mean, and each
        np.testing.assert_allclose(rms.values[0], alone["lateral_force_rms"].values[0], rtol=0.01)
