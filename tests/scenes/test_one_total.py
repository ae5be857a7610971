"""One total sound level of a run, with all that radiates, wherever a total is told: to the last digit."""

import csv
import json
import re

import numpy as np
import pytest

import asperity
from asperity.case.bodies import Bodies, WheelOnRail
from asperity.case.scene import Case
from asperity.cli.running import law_summaries
from asperity.optimising.definition import A_WEIGHTED, line_frequencies, measures_of
from asperity.reporting import data
from asperity.reporting.headline import force_answers, lights, validity
from asperity.reporting.page import answers_of
from asperity.reporting.sound import _sound_power
from asperity.scenes.figures import effects, measured, noise, sources
from asperity.scenes.report import chapters, page_of, write_page
from asperity.spectra import a_weighted_total, energy_sum, level_of
from asperity.studies.table import columns_of
from small_cases import HEARD

pytestmark = pytest.mark.usefixtures("in_cache_of_runs", "members_in_this_process")
TRAIN = {"vehicle_length": "26 m", "axle_positions": ["0 m", "2.5 m", "19 m"], "vehicle": "coach"}
ALONE = {"vehicle_length": "26 m", "vehicle": "coach"}
OFF = {"contact_place": "10 mm"}
BOGIE = {"radius": 0.46, "mass": 600.0, "load": 65e3, "transverse_radius": "inf", "section": "straight-web"}
BOGIE |= {"type": "bogie", "masses": [3000.0], "springs": [1.2e6], "dampers": [2e4], "distance": 2.5}
HEARD = HEARD | {
    "noise": TRAIN,
    "duration": "0.1 s",
    "settling": "50 ms",
    "numerics": {"highest_frequency": "2.5 kHz", "kernel": "scatter"},
}
OVER = {name: each for name, each in HEARD.items() if name != "wheel"}
CASES: dict[str, Case] = {
    "sideways": WheelOnRail(
        **HEARD | {"wheel": {"roughness": "disc", "section": "straight-web"}, "sideways": OFF}
    ),
    "bogie": Bodies(
        **OVER
        | {"over": "track", "body": BOGIE, "speed": 56.0, "start": "20 m", "sideways": OFF, "noise": ALONE},
    ),
    "without its wheel": WheelOnRail(**HEARD | {"sideways": OFF}),
    "up and down": WheelOnRail(**HEARD),
}


@pytest.fixture(params=CASES)
def run(request, runs):
    return CASES[request.param], runs(CASES[request.param])


def total(tree, name="spectra/radiated_power_level_a"):
    return float(tree[name].sel(radiator="total").values[0])


def own_parts(tree):
    held = tree["spectra/radiated_power_level_a"][0]
    parts = dict(zip(held["radiator"].values.tolist(), held.values.tolist(), strict=True))
    del parts["total"]
    return {name: level for name, level in parts.items() if np.isfinite(level)}


@pytest.mark.parametrize("kind", ["sideways", "bogie"])
def test_modes_of_the_wheel_add_up_to_its_part_of_the_total(kind, runs):
    """Both forces move them, and those too that answer the lateral one alone."""
    held = runs(CASES[kind])["spectra"].to_dataset()
    summed = energy_sum(np.nan_to_num(held["wheel_mode_power_level_a"].values[0], nan=-np.inf))
    assert float(summed) == pytest.approx(own_parts(runs(CASES[kind]))["wheel"], abs=1e-9)
    assert held["wheel_mode_diameters"].size == held["wheel_mode_power_level_a"].shape[1]
    assert held["wheel_mode_frequency"].values[0] == 0.0


def cells(table, row=0):
    return {head: cell.text for head, cell in zip(table.head, table.rows[row], strict=True)}


def test_the_total_is_the_sum_of_its_parts_band_by_band(run):
    held = run[1]["spectra"].to_dataset()
    level = held["radiated_power_level"].values[0]
    summed = energy_sum(np.nan_to_num(level[:-1], nan=-np.inf), axis=0)
    np.testing.assert_allclose(level[-1], summed, atol=1e-9)
    assert total(run[1]) == pytest.approx(a_weighted_total(level[-1], held["band"].values), abs=1e-9)


def test_headline_tile_table_page_and_summary_tell_it(run):
    """And no other: what is not the total is not called so."""
    _, tree = run
    whole, parts = total(tree), own_parts(tree)
    told = answers_of(tree, chapters())
    (power,) = (each for each in told.numbers if each.name == "sound power, own radiation model")
    assert power.value == f"{whole:.1f} dB(A)"
    assert ", ".join(f"{name} {level:.1f}" for name, level in parts.items()) in power.note
    assert f" of {whole:.1f} dB(A) of sound power" in told.lead
    (beside,) = (each for each in told.numbers if each.name == "pass-by, TEL")
    assert beside.value == f"{total(tree, 'pass_by/transit_exposure_level'):.1f} dB(A)"
    assert cells(noise.sound_power_table(tree))["total"] == f"{whole:.1f}"
    assert cells(noise.pass_by_table(tree))["TEL / dB(A)"] == beside.value.removesuffix(" dB(A)")
    level = total(tree, "pass_by/normalised_level")
    assert f"has {level:.1f} dB(A) at " in measured.limit_sentence(tree)
    assert measured.limits_table(tree).rows[0][1].text.startswith(f"{level:.1f} dB(A): rail ")
    for page in (page_of(tree), page_of(tree, summary=True)):
        text = re.sub(r"<[^>]+>", " ", page.replace("\u00a0", " "))
        assert f"{whole:.1f} dB(A)" in text
        assert "total with sideways" not in text


def test_json_and_csv_tell_it(run, tmp_path):
    _, tree = run
    (law,) = law_summaries(tree)
    assert law["radiated_power_level_a"]["total"] == total(tree)
    assert own_parts(tree).items() <= law["radiated_power_level_a"].items()
    for name in ("transit_exposure_level", "pass_by_maximum_level", "normalised_level"):
        assert law[name] == total(tree, f"pass_by/{name}")
    write_page(tree, tmp_path / "report.html")
    with open(tmp_path / "radiated_power_bands.csv", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    columns = dict(zip(head, np.array(rows, dtype=float).T, strict=False))
    band, level = columns["band centre [Hz]"], columns["total, linear [dB re 1 pW]"]
    assert float(a_weighted_total(level, band)) == pytest.approx(total(tree), abs=1e-9)


def test_comparison_optimisation_and_what_is_heard_have_it(run):
    case, tree = run
    table = asperity.compare(tree, tree)
    assert float(table["radiated_power_level_total_a"][0, 0]) == pytest.approx(total(tree), abs=1e-9)
    assert float(table["sound_exposure_level_total_a"][0, 0]) == pytest.approx(
        total(tree, "pass_by/sound_exposure_level_a"), abs=1e-9
    )
    measure, lines = measures_of(case)[A_WEIGHTED], line_frequencies(tree)
    found = level_of(measure.density(tree, "linear").sum() * (lines[1] - lines[0]))
    assert float(found) == pytest.approx(total(tree), abs=1e-9)
    assert ("without the wheel" in measure.meaning) == ("wheel" not in own_parts(tree))
    band, heard = _sound_power(tree)
    assert a_weighted_total(heard, band)[0] == pytest.approx(total(tree), abs=1e-9)


@pytest.mark.parametrize("kind", ["up and down", "bogie"])
def test_forces_of_all_contacts_are_those_of_tile_study_comparison_and_json(kind, runs):
    """Mean and variance over all contacts, and the largest force of any, wherever it is."""
    case, tree = CASES[kind], runs(CASES[kind])
    force = tree["rolling/contact_force"].sel(law="linear").transpose("contact", "time").values
    lost = tree["rolling/contact_loss_share"].sel(law="linear").max()
    rms, peak = np.sqrt(force.var(axis=1).mean()), force.max()
    study, compared = asperity.study(case, {"seed": [case.seed]}).isel(seed=0), asperity.compare(tree, tree)
    (told,) = law_summaries(tree)
    for table in (study.sel(law="linear"), compared.isel(run=0).sel(law="linear"), told):
        assert float(table["mean_force"]) == pytest.approx(force.mean(), rel=1e-12)
        assert float(table["rms_force"]) == pytest.approx(rms, rel=1e-12)
        assert float(table["peak_force"]) == peak
        assert float(table["contact_loss_share"]) == float(lost)
    several = len(force) > 1
    assert study["peak_force"].attrs["long_name"].endswith(", of 2 contacts") is several
    (tile, _) = force_answers(tree).numbers
    largest = f"at most {data.engineering(float(peak), 'N')}"
    assert tile.value == data.engineering(float(rms), "N")
    place = f" at contact {force.max(axis=1).argmax() + 1}" if several else ""
    assert tile.note.endswith(largest + place)


@pytest.mark.parametrize("kind", ["sideways", "bogie"])
def test_a_study_of_one_member_and_what_helps_tell_it(kind, runs):
    """A member of a study is computed as a run is; of the first also a wheel that is wider."""
    case, tree = CASES[kind], runs(CASES[kind])
    if kind == "bogie":
        (level,) = asperity.study(case, {"seed": [case.seed]})["radiated_power_level_a"].sel(radiator="total")
        assert float(level[0]) == pytest.approx(total(tree), abs=1e-9)
        return
    table = asperity.study(case, {"variant": {"wider": {"noise.wheel_width": "times 1.5"}}})
    as_it_is = table.sel(variant="as it is", law="linear")
    power = as_it_is["radiated_power_level_a"].sel(radiator="total")
    assert float(power) == pytest.approx(total(tree), abs=1e-9)
    for name in ("transit_exposure_level", "pass_by_maximum_level", "normalised_level"):
        assert float(as_it_is[name]) == pytest.approx(total(tree, f"pass_by/{name}"), abs=1e-9)
    heading, rows = columns_of(table)
    column = heading.index("radiated_power_level_a total [dB(A) re 1 pW]")
    assert rows[0][column] == pytest.approx(total(tree), abs=1e-9)
    found = asperity.effects(table)
    assert float(found["level"].sel(radiator="total")) == pytest.approx(total(tree), abs=1e-9)
    told = effects.Effects(found)
    assert cells(effects.effects_table(told))["total"] == f"{total(tree):.1f}"
    loudest = sources.main_sources(tree, noise.OWN_A).loudest
    assert told.loudest() == (loudest[0] if len(loudest) == 1 else f"{' and '.join(loudest)}, about equal")


def test_a_total_without_its_wheel_meets_no_limit_and_is_not_plainly_valid(runs):
    """Nor is it compared with one that has its wheel; over the limit already, it is over it."""
    tree = runs(CASES["without its wheel"])
    assert "without the wheel" in answers_of(tree, chapters()).lead
    quiet = tree.copy(deep=True)
    level = quiet["pass_by/normalised_level"]
    level.values -= total(tree, "pass_by/normalised_level") - tree["pass_by"].attrs["tsi_limit"] + 3.0
    assert "it is not known whether the limit is met" in measured.limit_sentence(quiet)
    assert measured.limits_table(quiet).rows[0][3].text == "–"
    level.values += 6.0
    assert "3.0 dB over the 79 dB(A) allowed even without the wheel's part" in measured.limit_sentence(quiet)
    assert measured.limits_table(quiet).rows[0][3].text == "no"
    conditions = json.loads(tree["pass_by"].attrs["reference_conditions"])
    assert [each["met"] for each in conditions if each["condition"] == "sources"] == [False]
    (silent,) = (each for each in lights(tree) if "rail and sleepers alone" in each.quantity)
    assert silent.state == "warning"
    assert not validity(lights(tree)).quantity.startswith("Valid")
    whole = runs(CASES["sideways"])
    table = asperity.compare(tree, whole, names=["silent", "ringing"])
    for name in ("radiated_power_level", "sound_exposure_level"):
        assert table[f"{name}_total_a"].notnull().all()
        assert table[f"{name}_total_a_difference"][1].isnull().all()
        assert table[f"{name}_rail_a_difference"][1].notnull().all()


def of(rail, wheel, by_chance, sideways=0.0):
    parts = {"rail": rail, "rail sideways": sideways, "sleepers": 60.0, "wheel": wheel}
    return sources.Sources(0.0, parts, dict.fromkeys(parts, by_chance))


@pytest.mark.parametrize(
    ("found", "words"),
    [
        (of(79.7, 79.1, 0.3), "rail and wheel are about equal"),
        (of(79.1, 79.7, 0.3), "wheel and rail are about equal"),
        (of(79.7, 79.1, 0.1), "the rail decides"),
        (of(79.7, 79.7, 0.0), "rail and wheel are about equal"),
        (of(79.0, 81.0, 0.1, sideways=79.0), "the rail decides"),  # by both its motions: 82.0
        (of(50.0, 51.0, 0.1), "the sleepers decide"),
        (of(79.0, 103.6, 0.5), "the wheel decides"),
    ],
)
def test_what_is_nearer_than_the_scatter_of_the_record_is_about_equal(found, words):
    """Two standard deviations of the difference of independent levels: 0.85 dB of 0.3 dB each."""
    assert sources.decides(found.loudest) == words


@pytest.mark.long
def test_the_deviation_of_a_level_is_that_of_other_seeds():
    """Of 24 seeds, by the A-weighted totals of rail and of a wheel that rings in few lines."""
    table = asperity.study(CASES["sideways"].with_(duration="0.2 s"), {"seed": list(range(1, 25))})
    level = table["radiated_power_level_a"].sel(law="linear")
    expected = np.sqrt((table["radiated_power_deviation"].sel(law="linear") ** 2).mean("seed"))
    ratio = level.std("seed", ddof=1) / expected
    assert ((ratio > 0.6) & (ratio < 1.7)).all()
