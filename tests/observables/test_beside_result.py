"""What a case names as measured, beside its result: how far it is off, how sure that is, and what is next."""

from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

import asperity
from asperity.case.cases import as_case, case_class
from asperity.case.measured_tables import MeasuredBearingKeys, MeasuredKeys
from asperity.observables import BUILT_IN, reading
from asperity.observables.beside_result import with_tables_beside
from asperity.running import prepare_case
from asperity.scenes import schema
from asperity.scenes.figures.measured import beside_measured, beside_table
from asperity.schema import bearing, contact, declared, spectra
from asperity.schema import measured as laid_out
from refusals import refusals
from small_cases import BALL, BEARING, HEARD, tree_of

BANDS = 10.0 ** (0.1 * np.arange(24, 28))  # 250 to 500 Hz


def of_beam():
    return tree_of(
        {
            spectra.LAW: ["linear"],
            spectra.BAND: BANDS,
            spectra.LEVEL_DEVIATION: [0.6, 0.6, 2.4, 2.4],
            spectra.FORCE_LEVEL: [[10.0, 12.0, 14.0, np.nan]],
            schema.SPECTRA_SENSOR: [0.2, 0.3],
            schema.ACCELERATION_LEVEL: [[[90.0] * 4, [90.0] * 4]],
            contact.APPROACH: [0.0, 1e-7, 1e-6],
            contact.FORCE: [0.0, 1.0, 100.0],
            contact.TANGENT_STIFFNESS: [0.0, 1e7, 1e9],
        }
    )


def of_bearing():
    return tree_of(
        {
            bearing.BAND_VELOCITY: [[[1e-5, 2e-5, 4e-5]]],
            bearing.BAND_DEVIATION: [[[0.1, 0.1, 0.1]]],
            bearing.ENVELOPE_FREQUENCY: np.arange(0.0, 200.0, 1.0),
            bearing.ENVELOPE: np.where(np.arange(200) == 108, 0.5, 0.01)[None],
        }
    )


TABLES = {
    "force_level": "frequency (Hz), level (dB re 1 N)\n250, 13\n315, 12\n500, 9\n",
    "acceleration_level": "frequency (Hz), level (dB re 1e-6 m/s^2)\n250, 84\n315, 91\n400, 80\n",
    "mobility": "frequency (Hz), mobility (m/s/N)\n100, 1e-3\n200, 2e-3\n300, 2e-3\n",
    "contact_stiffness": "load (N), stiffness (N/m)\n1, 2e7\n10, 1e8\n",
    "tone": "tone (Hz)\n107\n",
    "band_velocity": "frequency (Hz), velocity (um/s)\n100, 20\n1000, 20\n",
    "envelope_line": "frequency (Hz), envelope amplitude (m/s^2)\n107.4, 0.25\n",
}


@pytest.fixture
def beside(tmp_path):
    """A case that names tables, by the names of their keys."""

    def case(base, *names):
        for name in names:
            (tmp_path / f"{name}.csv").write_text(TABLES[name])
        tables = {name: str(tmp_path / f"{name}.csv") for name in names}
        return as_case(base | {"measured": tables})

    return case


def deviations(tree, quantity):
    """Deviation and its uncertainty, dB, of a quantity."""
    found = tree["measured"]
    own = found["quantity"].values == quantity
    return found["deviation"].values[own], found["deviation_uncertainty"].values[own]


def test_what_fits_read_and_reports_compare_is_one_list():
    """Each quantity names the key of its table; each key of these sections is that of a quantity."""
    models = [case_class(kind) for kind in ("ball-on-beam", "wheel-on-rail", "ball-bearing")]
    keys = {key for of in BUILT_IN.values() for key in of.keys}
    for key in keys:
        title, _, name = key.partition(".")
        assert any(
            title in model.sections() and name in model.sections()[title].model.keys for model in models
        )
    named = {f"measured.{name}" for model in (MeasuredKeys, MeasuredBearingKeys) for name in model.keys}
    assert named == {key for key in keys if key.startswith("measured.")}
    assert set(TABLES) == {name.removeprefix("measured.") for name in named}


def test_levels_of_a_beam_are_off_by_their_difference(beside):
    """One dB of measuring and the chance of the record add as squares; what is not computed is left open."""
    case = beside(BALL, "force_level", "acceleration_level")
    tree = with_tables_beside(case, of_beam())
    force, sure = deviations(tree, "contact force level")
    assert_allclose(force, [3.0, 0.0, np.nan])
    assert_allclose(sure, [np.sqrt(1.36), np.sqrt(1.36), np.nan])
    acceleration, sure = deviations(tree, "acceleration level")
    assert_allclose(acceleration, [-6.0, 1.0, -10.0])
    assert_allclose(sure, [np.sqrt(1.36), np.sqrt(1.36), 2.6])
    assert_allclose(tree["measured"]["measured"][:3], [13.0, 12.0, 9.0])
    assert set(tree["measured"].variables) == {entry.name for entry in declared(laid_out)}
    assert [each.what for each in reading.beside(case)] == ["contact force level", "acceleration level"]


def test_stiffness_and_mobility_are_off_by_a_ratio(beside):
    case = beside(BALL, "contact_stiffness", "mobility")
    tree = with_tables_beside(case, of_beam())
    stiffness, sure = deviations(tree, "contact stiffness")
    assert_allclose(stiffness, [20.0 * np.log10(2.0), 0.0], atol=1e-9)
    assert_allclose(sure, 0.5)
    over, middle = case.rolled_over, 0.5 * sum(case.rolled_over.extent)
    at = np.array([100.0, 200.0, 300.0])
    receptance = asperity.structures.modal.modal_receptance(over.model(2000.0), at, middle, middle)
    expected = 20.0 * np.log10([1e-3, 2e-3, 2e-3] / np.abs(2j * np.pi * at * receptance))
    assert_allclose(deviations(tree, "mobility")[0], expected, rtol=1e-9)


def test_of_a_mobility_with_its_phase_the_size_is_compared(beside, monkeypatch):
    rows = "100, 0.6e-3, 0.8e-3\n200, 1.2e-3, 1.6e-3\n300, 1.2e-3, -1.6e-3\n"
    monkeypatch.setitem(TABLES, "mobility", f"frequency (Hz), real (m/s/N), imaginary (m/s/N)\n{rows}")
    found = with_tables_beside(beside(BALL, "mobility"), of_beam())["measured"]
    assert_allclose(found[laid_out.VALUE.name].values, [1e-3, 2e-3, 2e-3])
    assert (found[laid_out.COMPUTED.name].values > 0.0).all()


def test_a_bearing_is_off_in_bands_lines_and_tones(beside):
    """A relative deviation of 0.1 is 0.87 dB, the chance of a line 0.4 dB, beside 1 dB of measuring."""
    case = beside(BEARING, "band_velocity", "envelope_line", "tone")
    tree = with_tables_beside(case, of_bearing())
    velocity, sure = deviations(tree, "bearing band velocity")
    assert_allclose(velocity, [6.0206, 0.0], atol=1e-3)
    assert_allclose(sure, np.hypot(1.0, 0.8686), rtol=1e-3)
    line, sure = deviations(tree, "envelope line")
    assert_allclose(line, 20.0 * np.log10(0.5))
    assert_allclose(sure, np.hypot(1.0, 0.4))
    tone, _ = deviations(tree, "bearing tone")
    tones = [*map(case.kinematics.tone, ("outer", "inner", "ball")), case.kinematics.cage]
    assert np.abs(tone[0] - 20.0 * np.log10(107.0 / np.array(tones))).min() < 1e-9
    table = beside_table(tree)
    cells = {row[0].text: [cell.text for cell in row[1:]] for row in table.rows[:2]}
    assert cells["bearing tone"][:2] == ["107 Hz", "107 Hz"]
    assert cells["bearing tone"][3:] == [f"−{abs(tone[0]):.3f}", "± 0.02"]
    assert cells["bearing band velocity"] == ["100 Hz", "20 µm/s", "10 µm/s", "+6.0", "± 2.6"]
    assert f"Bearing tone: {abs(tone[0]):.2g} dB rms in 1 value, 1 of them beyond" in table.note


def test_a_run_lays_it_out_unless_it_is_brief(beside, monkeypatch):
    case = beside(BALL, "force_level")
    monkeypatch.setattr("asperity.scenes.result.computed_result", lambda *_, brief: of_beam())
    ready = SimpleNamespace(case=case, caught=(), chosen={})
    assert "measured" in asperity.run(ready).children
    assert "measured" not in asperity.run(ready, brief=True).children
    plain = SimpleNamespace(case=as_case(BALL), caught=(), chosen={})
    assert "measured" not in asperity.run(plain).children


def test_what_was_measured_at_another_speed_is_for_fits_alone(beside):
    case = beside(BALL, "force_level")
    head, slow, fast = "run, speed (m/s)", "a, 1", "b, 2"
    wide = f"{head}, 200 Hz, 250 Hz, 315 Hz, 400 Hz, 500 Hz\n{slow}, 1, 12, 3, 4, 5\n{fast}, 1, 22, 3, 4, 5\n"
    case.measured.force_level.write_text(wide)
    found = with_tables_beside(case, of_beam())["measured"]
    assert_allclose(found["measured"], [1.0, 12.0, 3.0, 4.0, 5.0])
    assert len(reading.beside(case)) == 2


def test_the_report_says_how_far_and_what_next(beside):
    tree = with_tables_beside(beside(BALL, "force_level", "acceleration_level"), of_beam())
    table = beside_table(tree)
    cells = [[cell.text for cell in row] for row in table.rows]
    assert cells[0] == ["contact force level", "250 Hz", "13.0 dB re 1 N", "10.0 dB re 1 N", "+3.0", "± 2.3"]
    assert [row[4] for row in cells] == ["+3.0", "(0.0)", "–", "−6.0", "(+1.0)", "−10.0"]
    assert [cells[2][3], cells[2][5], cells[5][5]] == ["–", "–", "± 5.1"]
    assert "Contact force level: 2.1 dB rms in 2 values, 1 of them beyond 95 %" in table.note
    assert table.note.endswith("Next: asperity fit CASE, which fits keys of the case to it.")
    drawn = beside_measured.drawn(tree)
    assert_allclose(
        drawn.columns["contact force level, measured over computed [dB]"], [3.0, 0.0, np.nan, np.nan]
    )
    assert_allclose(drawn.columns["frequency [Hz]"], BANDS)


def test_nothing_is_next_where_chance_explains_all(beside):
    case = beside(BALL, "force_level")
    case.measured.force_level.write_text("frequency (Hz), level (dB re 1 N)\n250, 11\n315, 12\n400, 14\n")
    assert "Next" not in beside_table(with_tables_beside(case, of_beam())).note


def prepared(base, name, text, beside):
    """A case that names a table of some content, laid ready."""
    case = beside(base, name)
    getattr(case.measured, name).write_text(text)
    return prepare_case(case)


ON_RAIL = HEARD | {"kind": "wheel-on-rail"}
test_tables_that_a_case_cannot_be_held_against_are_refused = refusals(
    (
        ON_RAIL,
        "acceleration_level",
        TABLES["acceleration_level"],
        "measured.acceleration_level: received a case with no accelerometers on what is rolled over; allowed",
    ),
    (BALL, "force_level", "frequency (Hz), height (mm)\n250, 3\n315, 4\n", "force_level.csv"),
    of=prepared,
)
