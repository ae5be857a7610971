"""Cases of any bodies: what may be asked for, and what is said where it may not."""

import warnings

import numpy as np
import pytest

from asperity import Beam, Bodies, ModalStructure, Wheel, WheelOnRail, material
from asperity.case.cases import parse_case, template
from asperity.errors import (
    CaseError,
    EnergyWarning,
    Grade,
    HalfSpaceWarning,
    InputError,
    PhysicsWarning,
    ShortRecordWarning,
    UnconvergedWarning,
)
from asperity.scenarios.geometry import geometry_of
from asperity.scenarios.scene import scene_of
from asperity.scenarios.textures import other_contacts, textures_of
from asperity.scenes.result import passing_frequencies

ROUGH = {"rms": "0.05 um", "longest": "0.4 mm", "shortest": "80 um"}
COARSE = {"spacing": "20 um", "window": "0.6 mm", "samples": 2, "sample_length": "1.4 mm"}
BOGIE = {
    "type": "bogie",
    "masses": [3000],
    "springs": [1.2e6],
    "dampers": [2e4],
    "distance": 2.5,
    "mass": 600,
}


def case_of(body=(), **keys):
    return Bodies(**{"surface": ROUGH, "contact": COARSE, "body": dict(body), **keys})


def test_the_template_reads_as_the_default_case():
    assert parse_case(template("bodies")) == Bodies(
        duration=0.12, surface={"rms": "0.1 um"}, body={"load": 50}
    )


class TestBodies:
    def test_a_ball_weighs_what_its_sphere_does(self):
        (ball,) = scene_of(case_of()).rolling
        mass = 4.0 / 3.0 * np.pi * 25e-3**3 * 7850.0
        assert ball.mass[0, 0] == pytest.approx(mass, rel=0.01)
        assert ball.static_loads == pytest.approx([mass * 9.80665], rel=0.01)

    def test_a_load_holds_all_weights(self):
        body = {"type": "chain", "mass": 600, "masses": [1000, 5000], "springs": [1e6, 2e5], "load": 65e3}
        (chain,) = scene_of(case_of(body)).rolling
        assert chain.static_loads == pytest.approx([65e3])
        assert np.diag(chain.mass) == pytest.approx([600, 1000, 5000])

    def test_without_a_load_the_weights_are_carried(self):
        (bogie,) = scene_of(case_of(BOGIE, over="plane")).rolling
        assert bogie.static_loads == pytest.approx(9.80665 * np.full(2, 600 + 1500))
        assert bogie.mass[3, 3] == pytest.approx(3000 * 2.5**2 / 12)

    def test_bodies_stand_behind_one_another(self):
        case = case_of(BOGIE | {"positions": ["0 m", "10 m"]}, over="plane")
        assert case.body.offsets == (0.0, 2.5, 10.0, 12.5)
        wheels = {"rear wheel, body 2": 1.0, "front wheel, body 2": 1.0}
        frame = {"frame, body 2": 1.0, "frame, pitch at its end, body 2": 1.25}
        assert dict(list(scene_of(case).degrees.items())[4:]) == wheels | frame

    def test_elements_of_a_carriage_press_it_up_by_hertz(self):
        body = {"type": "carriage", "masses": [0.4], "distance": 0.02, "radius": 3e-3, "load": 20.0}
        case = case_of(body)
        (carriage,) = scene_of(case).rolling
        hertz = case.smooth_contact
        above = 20.0 - 9.80665 * case.body.contact_mass
        expected = hertz.tangent_stiffness(hertz.approach(above))
        assert carriage.stiffness[0, 0] == pytest.approx(expected)


class TestSmoothContact:
    def test_a_ball_on_a_plane_is_round(self):
        found = case_of().smooth_contact
        assert (found.radius_x, found.radius_y) == pytest.approx((25e-3, 25e-3))

    def test_a_groove_conforms_and_a_raceway_bends(self):
        """1/R: 1/3 − 1/3.12 across; around an inner ring 1/3 + 1/20 along, inside an outer one 1/3 − 1/20."""
        keys = {"radius": 3e-3, "groove_radius": 3.12e-3, "raceway_radius": 20e-3}
        inner = case_of(keys).smooth_contact
        outer = case_of(keys | {"raceway": "outer"}).smooth_contact
        assert inner.radius_y == pytest.approx(78e-3)
        assert inner.radius_x == pytest.approx(1e-3 / (1 / 3 + 1 / 20))
        assert outer.radius_x == pytest.approx(1e-3 / (1 / 3 - 1 / 20))

    def test_a_wheel_lies_on_the_head_of_its_rail(self):
        case = case_of({"radius": 0.46, "transverse_radius": "inf", "load": 65e3, "mass": 600}, over="track")
        assert case.smooth_contact.radius_y == pytest.approx(0.3)


class TestGroove:
    KEYS = {"radius": 3e-3, "groove_radius": 3.12e-3, "mass": 0.05}  # noqa: RUF012

    def contact(self, load, **keys):
        grid = {"spacing": "20 um", "window": "4 mm", "samples": 1, "sample_length": "9 mm"}
        return geometry_of(case_of(self.KEYS | {"load": load} | keys, contact=grid))

    @pytest.mark.filterwarnings("ignore::asperity.errors.CoarseSamplingWarning")
    def test_the_gap_is_that_of_circle_in_circle(self):
        """Distance of the ball from points along the arc of the groove."""
        found = self.contact(5.0)
        s = 2e-5 * (np.arange(found.body.shape[1]) - found.body.shape[1] // 2)
        middle = found.body[found.body.shape[0] // 2]
        ball, groove = 3e-3, 3.12e-3
        x, y = groove * np.sin(s / groove), groove * (1 - np.cos(s / groove))
        np.testing.assert_allclose(middle, np.hypot(x, y - ball) - ball, rtol=1e-3, atol=1e-12)
        assert found.semi_axes[1] > 5 * found.semi_axes[0]

    @pytest.mark.filterwarnings("ignore::asperity.errors.CoarseSamplingWarning")
    def test_where_the_half_space_ends_in_it(self):
        with pytest.warns(HalfSpaceWarning, match="rad of the groove to either side"):
            self.contact(800.0, groove_radius=3.05e-3, mass=1.0)
        with pytest.raises(InputError, match=r"fills .* rad of the groove"):
            self.contact(5000.0, groove_radius=3.05e-3, mass=1.0)
        with pytest.raises(InputError, match=r"width of the groove.*The edge would carry"):
            self.contact(20.0, groove_width=0.2e-3)


class TestTextures:
    def test_the_path_reaches_to_the_foremost_contact(self):
        near = textures_of(case_of(duration="50 ms", settling="10 ms"))
        far = textures_of(case_of({"positions": ["0 m", "0.1 m"]}, duration="50 ms", settling="10 ms"))
        assert len(far.line) - len(near.line) == 5000
        assert far.start == near.start

    def test_bodies_that_are_smooth_share_one_law(self):
        case = case_of({"positions": ["0 m", "0.1 m", "0.3 m"]})
        which, others = other_contacts(case, np.full(3, 5.0))
        assert (which, others) == ([0, 0, 0], [])

    def test_loads_and_textures_of_their_own_make_laws_of_their_own(self):
        which, others = other_contacts(case_of(), np.array([5.0, 7.0, 5.0, 7.0]))
        assert which == [0, 1, 0, 1]
        assert [other.load for other in others] == [7.0]
        rough = {"positions": ["0 m", "0.1 m"], "roughness": "disc", "radius": 0.46}
        case = Bodies(
            over="plane", speed=20, surface={"spectrum": "iso3095"}, body=rough, duration="0.2 s",
            contact={"spacing": "1 mm", "window": "20 mm"}, laws=["linear"],
        )  # fmt: skip
        which, others = other_contacts(case, np.full(2, 5.0))
        assert which == [0, 1]
        first = textures_of(case)
        second = others[0].textures(first)
        around = round(2 * np.pi * 0.46 / 1e-3)
        change = second.line - first.line
        assert change.std() > 1e-6
        np.testing.assert_allclose(change[around:], change[:-around], atol=1e-15)  # both turn


class TestPlane:
    def test_a_plane_has_a_material(self):
        case = case_of(over="plane", structure={"material": "glass"})
        assert case.smooth_contact.modulus < case_of(over="plane").smooth_contact.modulus


class TestSupports:
    def test_a_support_in_the_middle_makes_two_spans(self):
        """Twice the length on three supports: the antisymmetric modes are those of one span."""
        one = scene_of(case_of(beam={"length": 0.5, "modes_up_to": "20 kHz"})).over
        two = scene_of(case_of(beam={"supports": [0.5], "modes_up_to": "20 kHz"})).over
        np.testing.assert_allclose(two.natural_frequencies[:8:2], one.natural_frequencies[:4], rtol=1e-8)

    def test_springs_carry_a_free_beam(self):
        """The bounce of a stiff beam on two springs: sqrt(2k/m), damped by half their loss factor."""
        keys = {
            "support": "free",
            "supports": [0.2, 0.8],
            "support_stiffness": 10.0,
            "support_loss_factor": 0.1,
        }
        beam = scene_of(case_of(beam=keys)).over
        mass = 0.05 * 0.01 * 7850.0
        assert beam.natural_frequencies.min() < np.sqrt(20.0 / mass) / (2 * np.pi) * 1.01
        assert beam.damping_ratios[:2] == pytest.approx([0.05, 0.05], rel=1e-3)


class TestStructure:
    def test_modes_from_memory_are_rolled_over_where_they_are(self):
        x = np.linspace(2.0, 3.0, 41)
        modes = ModalStructure(x, [200.0], 0.01, np.sin(np.pi * (x - 2.0))[:, None], modal_masses=[2.0])
        case = case_of({"positions": ["0 m", "0.2 m"]}, over="structure", structure={"file": modes})
        assert case.rolled_range[0] == pytest.approx(2.0)
        assert case.rolled_range[1] == pytest.approx(2.8)
        assert case.structure.sensor_positions[2] == pytest.approx(2.5)
        other = ModalStructure(x, [201.0], 0.01, np.sin(np.pi * (x - 2.0))[:, None], modal_masses=[2.0])
        assert case != case.with_(structure={"file": other})
        with pytest.raises(InputError, match="where a case shall be written"):
            case.to_toml()

    def test_what_cannot_be_read_is_told(self, tmp_path):
        (tmp_path / "modes.csv").write_text("frequency (Hz), 10\n")
        with pytest.raises(CaseError, match=r"structure\.file"):
            case_of(over="structure", structure={"file": tmp_path / "modes.csv"})

    def test_sensors_stand_on_the_structure(self):
        x = np.linspace(0.0, 1.0, 41)
        modes = ModalStructure(x, [200.0], 0.01, np.sin(np.pi * x)[:, None], modal_masses=[2.0])
        with pytest.raises(CaseError, match=r"structure\.sensors: received 2 m"):
            case_of(over="structure", structure={"file": modes, "sensors": [2.0]})


def test_equal_distances_have_passing_tones():
    assert passing_frequencies([0.0, 0.02, 0.04], 1.0, 180.0) == pytest.approx([50.0, 100.0, 150.0])
    assert passing_frequencies([0.0, 0.02, 0.05], 1.0, 180.0).size == 0
    assert passing_frequencies([0.0], 1.0, 180.0).size == 0


def receptances(beam, frequency, noise=0.0):
    """Table of the receptances of a beam at 19 places under a force at one of them."""
    places, driven = np.linspace(0.0, beam.length, 21), 0.3 * beam.length
    random = np.random.default_rng(1)
    rows = []
    for place in places[1:-1]:
        found = beam.receptance(frequency, place, driven)
        found = found * (1.0 + noise * (random.normal(size=len(found)) + 1j * random.normal(size=len(found))))
        rows += [[f, place, driven, h.real, h.imag] for f, h in zip(frequency, found, strict=True)]
    return np.array(rows)


LOW = {"highest_frequency": "250 Hz"}


class TestReceptances:
    BEAM = Beam.rectangular(1.0, 0.05, 0.01, material("steel"), loss_factor=0.02, highest_frequency=500.0)

    def test_they_are_fitted_by_modes(self):
        table = receptances(self.BEAM, np.arange(2.0, 500.0, 0.5))
        keys = {"over": "structure", "structure": {"receptances": table}, "start": 0.2, "duration": 0.1}
        case = case_of(**keys, numerics=LOW)
        model = scene_of(case).over
        assert case.structure.sensor_positions[0] == pytest.approx(0.23)
        measured = self.BEAM.receptance([80.0], 0.3, 0.3)
        assert model.receptance([80.0], 0.3, 0.3) == pytest.approx(measured, rel=0.02)

    def test_doubts_are_those_of_the_run_not_of_reading(self):
        """Noise of a third of the receptance is told where the bodies are built, not where keys are read."""
        table = receptances(self.BEAM, np.arange(2.0, 400.0, 1.0), noise=0.3)
        keys = {"over": "structure", "structure": {"receptances": table}, "start": 0.2, "duration": 0.1}
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            case = case_of(**keys)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", PhysicsWarning)
            scene_of(case)
        assert {EnergyWarning, UnconvergedWarning} <= {each.category for each in caught}

    @pytest.mark.parametrize(("end", "graded"), [(500.0, None), (375.0, Grade.WARNING), (200.0, Grade.OUT)])
    def test_receptances_that_end_below_twice_the_highest_frequency_are_warned_of(self, end, graded):
        """Of a structure, a body and a wheel."""
        frequency = np.arange(2.0, end + 1.0, 2.0)
        wheel = Wheel(600.0, 65e3, *TestResonances.MODES.T).receptance(frequency)
        point = np.column_stack([frequency, wheel.real, wheel.imag])
        over = {"receptances": receptances(self.BEAM, frequency)}
        body = {"mass": 600.0, "load": 65e3, "radius": 0.46, "receptance": point}
        cases = {
            "structure": case_of(over="structure", structure=over, start=0.2, duration=0.1, numerics=LOW),
            "body": case_of(body, over="plane", numerics=LOW),
            "wheel": WheelOnRail(
                surface={"smooth": True}, wheel={"mass": 600.0, "receptance": point}, numerics=LOW
            ),
        }
        for what, case in cases.items():
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always", PhysicsWarning)
                scene_of(case)
            told = [each.message for each in caught if each.category is ShortRecordWarning]
            assert [message.grade for message in told] == ([graded] if graded else [])
            ends = (
                f"of the {what} end at 374 Hz, 1.5 times numerics.highest_frequency; 2 times it, 500 Hz, are"
            )
            remedy = "Give them to 500 Hz, or lower numerics.highest_frequency to 188 Hz"
            assert graded is not Grade.WARNING or (ends in str(told[0]) and remedy in str(told[0]))

    @pytest.mark.filterwarnings("ignore::asperity.errors.EnergyWarning")
    def test_a_wheel_is_fitted_to_twice_the_highest_frequency(self):
        """A mode just above it is found in a record with 2 % of noise; fitted to it alone, it is a guess."""
        wheel = Wheel(600.0, 65e3, [100.0, 290.0], [0.01, 0.002], [300.0, 100.0])
        frequency, random = np.arange(5.0, 500.0, 0.5), np.random.default_rng(1)
        noise = 0.02 * (random.normal(size=frequency.size) + 1j * random.normal(size=frequency.size))
        found = wheel.receptance(frequency) * (1.0 + noise)
        keys = {"mass": 600.0, "receptance": np.column_stack([frequency, found.real, found.imag])}
        (fitted,) = scene_of(WheelOnRail(surface={"smooth": True}, wheel=keys, numerics=LOW)).rolling
        assert np.abs(fitted.natural_frequencies / 290.0 - 1.0).min() < 1e-4

    def test_one_source_and_a_complete_table(self):
        table = receptances(self.BEAM, np.arange(2.0, 400.0, 0.5))
        with pytest.raises(CaseError, match=r"structure\.receptances.*Complete the table"):
            case_of(over="structure", structure={"receptances": table[1:]})
        x = np.linspace(0.0, 1.0, 41)
        modes = ModalStructure(x, [200.0], 0.01, np.sin(np.pi * x)[:, None], modal_masses=[2.0])
        with pytest.raises(CaseError, match="both file and receptances"):
            case_of(over="structure", structure={"receptances": table, "file": modes})


class TestResonances:
    MODES = np.array([[800.0, 0.01, 20.0], [1500.0, 0.02, 15.0]])

    def test_what_touches_resonates_at_each_contact(self):
        (bogie,) = scene_of(case_of(BOGIE | {"modes": self.MODES}, over="plane")).rolling
        assert bogie.natural_frequencies == pytest.approx([800.0, 1500.0, 800.0, 1500.0])
        assert bogie.shapes[1] == pytest.approx([0.0, 0.0, 20.0**-0.5, 15.0**-0.5])

    def test_a_mass_is_known_by_its_receptance(self):
        wheel = Wheel(600.0, 65e3, *self.MODES.T)
        frequency = np.arange(20.0, 10000.0, 4.0)
        found = wheel.receptance(frequency)
        table = np.column_stack([frequency, found.real, found.imag])
        body = {"mass": 600.0, "load": 65e3, "receptance": table, "radius": 0.46}
        (fitted,) = scene_of(case_of(body, over="plane")).rolling
        assert fitted.natural_frequencies[:2] == pytest.approx([800.0, 1500.0], rel=1e-3)
        assert fitted.static_loads == pytest.approx([65e3])
        with pytest.raises(CaseError, match="both modes and receptance"):
            case_of(body | {"modes": self.MODES}, over="plane")
