"""Measured pads and sleepers in a case: tables in all their forms, the preload of the wheel, messages."""

from pathlib import Path

import numpy as np
import pytest

from asperity import Track, WheelOnRail
from asperity.case.cases import parse_case
from asperity.case.tables import read_dynamic_stiffness
from asperity.errors import CaseError, UnconvergedWarning
from asperity.scenes.noise import sleeper_top
from asperity.structures import support
from asperity.structures.support import StiffnessTable

EXAMPLE = Path(__file__).parents[2] / "examples" / "pad_stiffness.csv"
PARTS = "frequency (Hz), real part (MN/m), imaginary part (MN/m)\n10, 90, 9\n300, 120, 18\n2000, 160, 40\n"
BY_LOSS = """# a pad at 20 °C
frequency (Hz); dynamic stiffness (kN/mm); loss factor; preload (kN)
10; 150,75; 0,1; 20
300; 150,75; 0,1; 20
2000; 150,75; 0,1; 20
300; 301,50; 0,1; 60
10; 301,50; 0,1; 60
2000; 301,50; 0,1; 60
"""


def pad(tmp_path, text):
    (tmp_path / "pad.csv").write_text(text, encoding="utf-8")
    return tmp_path / "pad.csv"


def case_of(table, **track):
    surface = {"spectrum": "iso3095"}
    return WheelOnRail(surface=surface, track={"name": "uic60", "pad_table": table, **track})


def test_parts_and_loss_factors_are_read(tmp_path):
    rows = read_dynamic_stiffness(pad(tmp_path, PARTS))
    np.testing.assert_allclose(rows, [(10, 9e7, 9e6), (300, 1.2e8, 1.8e7), (2000, 1.6e8, 4e7)])
    np.testing.assert_array_equal(read_dynamic_stiffness(rows), rows)
    rows = read_dynamic_stiffness(pad(tmp_path, BY_LOSS))
    np.testing.assert_allclose(np.abs(rows[:, 1] + 1j * rows[:, 2]), [150.75e6] * 3 + [301.5e6] * 3)
    np.testing.assert_allclose(rows[:, 2] / rows[:, 1], 0.1)
    assert set(rows[:, 3]) == {20e3, 60e3}


def test_a_table_of_many_preloads_takes_time_with_their_number(monkeypatch):
    """Each of them is looked at once, and to find one between them two are."""
    made = []
    monkeypatch.setattr(
        support, "StiffnessTable", lambda *parts: made.append(parts) or StiffnessTable(*parts)
    )
    rows = np.array([(f, 1e8 + 1e5 * p, 1e7, 1e3 * p) for p in range(1, 401) for f in (10.0, 100.0, 1e3)])
    read_dynamic_stiffness(rows[::-1])
    assert len(made) == 400
    assert support.stiffness_at_preload(rows, 20.5e3).real[0] == pytest.approx(1e8 + 20.5e5)
    assert len(made) == 403


def test_the_wheel_decides_the_preload(tmp_path):
    """The support below the wheel carries K w of it, on pads that are as stiff as under that force."""
    table = pad(tmp_path, BY_LOSS)
    light, heavy = (case_of(table).with_(wheel={"load": load}) for load in ("70 kN", "100 kN"))
    for case, load in ((light, 70e3), (heavy, 100e3)):
        track, preload = case.track.model(), case.track.pad_preload
        assert preload == pytest.approx(track.support.static * track.static_deflection(load), rel=1e-9)
        place = (preload - 20e3) / 40e3
        assert track.pad_stiffness == pytest.approx(150e6 * (1.0 + min(max(place, 0.0), 1.0)), rel=1e-3)
    assert 20e3 < light.track.pad_preload < heavy.track.pad_preload < 60e3
    assert "pad_preload" not in light.to_toml()
    (said,) = heavy.track.described_tables
    assert said == ("measured pads", "pad.csv at 38.2 kN, measured from 20 to 60 kN: 218.3 MN/m at 300 Hz")
    assert not list(WheelOnRail(surface={"spectrum": "iso3095"}).track.described_tables)
    assert case_of(table, pad_preload="60 kN").track.model().pad_stiffness == pytest.approx(300e6, rel=1e-3)


def test_a_given_stiffness_scales_the_table(tmp_path):
    track = case_of(pad(tmp_path, PARTS), pad_stiffness="240 MN/m").track.model()
    at = 2.0 * np.pi * np.array([10.0, 2000.0])
    np.testing.assert_allclose(track.springs["pad"].stiffness(at), [180e6 + 18e6j, 320e6 + 80e6j])
    assert (track.pad_damping, track.pad_loss_factor) == (None, None)


def test_a_sleeper_that_bends_is_as_long_as_it_sounds():
    bent = {"name": "uic60", "sleeper_bending_stiffness": "6 MN m^2", "sleeper_length": "2.4 m"}
    for track, noise, length in (
        (bent, {}, 2.4),
        (bent, {"sleeper_length": "2.5 m"}, 2.5),
        ({"name": "uic60"}, {}, 2.6),
    ):
        case = WheelOnRail(surface={"spectrum": "iso3095"}, track=track, noise=noise)
        assert sleeper_top(case, case.track.model()).length == length


def test_the_example_is_a_case_that_reads_as_it_was_written(tmp_path):
    case = case_of(EXAMPLE)
    again = parse_case(case.to_toml(), EXAMPLE)
    assert again == case
    assert again.track.model() == case.track.model()
    assert "Made up" in EXAMPLE.read_text(encoding="utf-8").splitlines()[0]


# --- sleepers

SEAT = 2.0 * np.pi * np.geomspace(15.0, 3000.0, 40)


def sleepers(tmp_path, receptance, **track):
    """A case with a table of receptances (40,), m/N, in a file, in µm/kN and degrees."""
    rows = np.column_stack([SEAT / (2.0 * np.pi), 1e9 * np.abs(receptance), np.degrees(np.angle(receptance))])
    lines = "\n".join(", ".join(map(repr, row)) for row in rows.tolist())
    text = f"frequency (Hz), magnitude (um/kN), phase (deg)\n{lines}\n"
    (tmp_path / "seat.csv").write_text(text, encoding="utf-8")
    keys = {"name": "uic60", "sleeper_table": tmp_path / "seat.csv", "sleeper_mass": 140.0, **track}
    return WheelOnRail(surface={"spectrum": "iso3095"}, track=keys)


def test_sleepers_are_read(tmp_path):
    ballast = {"ballast_stiffness": 90e6, "ballast_loss_factor": 0.8}
    at = np.array([60.0, 400.0, 1500.0])
    expected = Track.named("uic60", sleeper_mass=140.0, **ballast).receptance(at, 0.0, 0.0)
    case = sleepers(tmp_path, -1.0 / (140.0 * SEAT**2), **ballast)
    np.testing.assert_allclose(case.track.model().receptance(at, 0.0, 0.0), expected, rtol=1e-9)
    ((named, said),) = case.track.described_tables
    assert named == "measured sleepers"
    assert said.startswith("seat.csv: 0 modes on 140 kg")


def test_sleepers_that_do_not_fit_are_told(tmp_path):
    free, bed = -1.0 / (140.0 * SEAT**2), 90e6 * (1.0 + 0.8j)
    with pytest.warns(UnconvergedWarning, match=r"on 115 kg.* of the sleeper in seat\.csv to 1\.6 dB"):
        sleepers(tmp_path, free, sleeper_mass=115.0).track.model()
    with pytest.raises(CaseError, match=r"modes on 140 kg \(.* dB off at most.* meet to"):
        sleepers(tmp_path, 1.0 / (bed - 140.0 * SEAT**2))
    with pytest.raises(CaseError, match=r"from 15 to 3000 Hz, by which the sleeper would make energy"):
        sleepers(tmp_path, -1j * free)
