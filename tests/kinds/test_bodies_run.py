"""Runs of any bodies against the two named kinds, against each other, and against what must come out."""

import numpy as np
import pytest

import asperity
from asperity import Beam, Bodies, material

pytestmark = pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")

LINE = {"spectrum": "iso3095", "level": "-40 dB"}
GRID = {"spacing": "20 um", "window": "0.6 mm"}
BALL = {
    "laws": ["hertz", "linear"],
    "start": "0.3 m",
    "duration": "30 ms",
    "settling": "10 ms",
    "surface": LINE,
    "contact": GRID,
    "numerics": {"highest_frequency": "2 kHz"},
}


def forces(tree):
    return tree["rolling/contact_force"].values


@pytest.fixture(scope="module")
def on_beam():
    """A ball on a beam, as any bodies."""
    return asperity.run({"kind": "bodies", **BALL, "body": {"load": "30 N"}})


def test_one_ball_is_a_ball_on_a_beam(on_beam):
    """The same forces as of the named kind, whose stepper is another one."""
    named = asperity.run({"kind": "ball-on-beam", **BALL, "ball": {"load": "30 N"}})
    expected = named["rolling/contact_force"].values
    np.testing.assert_allclose(on_beam["rolling/contact_force"].values, expected, rtol=1e-9, atol=3e-8)
    for name in ("acceleration_level", "force_level"):
        np.testing.assert_allclose(on_beam[f"spectra/{name}"], named[f"spectra/{name}"], atol=1e-5)


def test_modes_of_a_file_are_the_beam(on_beam, tmp_path):
    """Forty modes of the same beam, written as a table at 1001 points: 1e-9 of the force in the same run."""
    beam = Beam.rectangular(1.0, 0.05, 0.01, material("steel"), highest_frequency=40e3)
    x, natural = np.linspace(0.0, 1.0, 1001), beam.natural_frequencies
    table = np.column_stack([x, beam.shapes(x)[0]])[:, :41]
    head = [("frequency (Hz)", natural[:40]), ("damping ratio", beam.damping_ratios[:40])]
    lines = [f"{name}, " + ", ".join(repr(float(v)) for v in row) for name, row in head]
    lines += ["position (m)"]
    lines += [", ".join(repr(float(v)) for v in row) for row in table]
    (tmp_path / "modes.csv").write_text("\n".join(lines))
    modes = {"over": "structure", "structure": {"file": str(tmp_path / "modes.csv")}}
    built_in = {"beam": {"modes_up_to": f"{0.5 * (natural[39] + natural[40]):.6f} Hz"}}
    shared = {
        "kind": "bodies",
        **BALL,
        "laws": ["hertz"],
        "body": {"load": "30 N", "positions": ["0 m", "0.2 m"]},
    }
    ours, expected = (asperity.run(shared | own) for own in (modes, built_in))
    scale = np.abs(forces(expected)).max()
    np.testing.assert_allclose(forces(ours), forces(expected), atol=1e-9 * scale, rtol=0)


DISTANCE, SPEED = 10e-3, 2.0


@pytest.fixture(scope="module")
def guide():
    """A carriage on four balls over a plane, whose texture the balls meet one after the other."""
    body = {
        "type": "carriage", "contacts": 4, "distance": DISTANCE, "radius": "3 mm", "load": "20 N",
        "masses": ["0.5 kg"], "mass": "2 g", "inertia": "1 kg m^2",
    }  # fmt: skip
    case = Bodies(
        over="plane", speed=SPEED, laws=["linear"], duration=2.0, settling=0.2, body=body,
        surface=LINE | {"level": "-70 dB"}, contact={"spacing": "40 um", "window": "0.4 mm"},
        numerics={"highest_frequency": "2 kHz", "time_step": "10 us"},
    )  # fmt: skip
    return asperity.run(case)


class TestGuide:
    def test_tones_at_k_v_over_l_and_cancellation_between_them(self, guide):
        """What four balls in a row do together: sin(4πfL/v)/sin(πfL/v), largest at k v/L, zero between."""
        spectra = guide["spectra"].to_dataset()
        together = spectra["body_acceleration_psd"].sel(degree="carriage", law="linear")
        frequency = together["frequency"].values
        phase = np.pi * frequency * DISTANCE / SPEED
        level = 10.0 * np.log10(together.values)

        def mean(places):
            near = np.abs(frequency[:, None] - places[None, :]).min(axis=1) < 1.0
            return float(np.mean(level[near]))

        tones = np.array([200.0, 400.0, 600.0])
        zeros = np.array([250.0, 300.0, 350.0, 450.0, 500.0, 550.0])
        assert mean(tones) - mean(zeros) > 20.0
        assert list(spectra["passing_frequency"].values[:3]) == pytest.approx([200.0, 400.0, 600.0])
        # over all frequencies in between, the factor of the row
        row = np.abs(np.sin(4 * phase) / (4 * np.sin(phase)))
        told = (row > 0.3) & (frequency > 120.0) & (frequency < 680.0)
        flat = level[told] - 20.0 * np.log10(row[told])
        trend = np.polynomial.Polynomial.fit(np.log(frequency[told]), flat, 2)
        assert np.std(flat - trend(np.log(frequency[told]))) < 3.0

    def test_the_balls_share_the_load_and_the_sum_moves_the_carriage(self, guide):
        rolling = guide["rolling"].to_dataset().sel(law="linear")
        assert rolling["static_load"].values == pytest.approx(np.full(4, 20.0))
        force = rolling["contact_force"].sum("contact").values
        assert force.mean() == pytest.approx(80.0, rel=1e-3)
        assert float(rolling["energy_residual"]) < 1e-5


def test_wheels_of_two_textures_differ():
    """Roughness of their own: each wheel another texture of the same spectrum."""
    case = {
        "kind": "bodies", "over": "plane", "speed": "20 m/s", "laws": ["linear"], "duration": "0.3 s",
        "surface": {"spectrum": "iso3095", "level": "-60 dB"},
        "contact": {"spacing": "1 mm", "window": "20 mm", "damping": "300 kN s/m"},
        "body": {
            "radius": "0.46 m", "transverse_radius": "0.3 m", "mass": "600 kg", "load": "65 kN",
            "roughness": "disc", "positions": ["0 m", "40 m"],
        },
        "numerics": {"highest_frequency": "2 kHz"},
    }  # fmt: skip
    result = asperity.run(case)
    one, other = forces(result)[0]
    assert abs(np.corrcoef(one, other)[0, 1]) < 0.2
    levels = result["spectra/contact_force_level"].values[0]
    assert np.nanmean(np.abs(levels[0] - levels[1])[-10:]) < 4.0
