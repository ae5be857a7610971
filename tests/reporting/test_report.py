"""The report: everything on one page, nothing from elsewhere, hostile text harmless, numbers exact."""

import html
import json
import re

import numpy as np
import pytest
import xarray as xr
from report_reading import HOSTILE, Reader, own_scripts
from report_tree import LAWS, PARTS, report_tree, with_force

import asperity
from asperity.convergence import sentence
from asperity.errors import ComputationError, InputError
from asperity.laws import spec_of
from asperity.reporting.chart import envelope, smooth_on_log_axis
from asperity.reporting.data import engineering, nominal_band, power_of_ten, unticked_laws
from asperity.reporting.headline import deciding_bands, force_answers, lights
from asperity.reporting.page import literature
from asperity.reporting.tables import uncertainty_table
from asperity.scenes.figures.motion import acceleration_answers
from asperity.scenes.report import page_of, report
from asperity.scenes.result import root_attributes
from asperity.spectra import a_weighting, nominal_frequency


@pytest.fixture(scope="module")
def tree():
    return report_tree()


@pytest.fixture(scope="module")
def folder(tree, tmp_path_factory):
    return report(tree, tmp_path_factory.mktemp("run") / "new").parent


@pytest.fixture(scope="module")
def text(folder):
    return (folder / "report.html").read_text(encoding="utf-8")


def small(**changes):
    """Tree of a short run; `changes` map a group to the variables dropped from it."""
    tree = report_tree(["areal", "linear"])
    for group, names in changes.items():
        tree[group] = tree[group].to_dataset().drop_vars(names)
    return tree


def contact_only(**attrs):
    """Tree with little to draw, for tests of the page's text."""
    tree = small(contact=["filter"])
    for group in ("surface", "rolling", "spectra"):
        del tree[group]
    tree.attrs.update({name: json.dumps(value) for name, value in attrs.items()})
    return tree


# --- the page


def test_the_page_says_where_it_comes_from(tree, text):
    shown = Reader(text).shown
    for fact in ("12 times", "asperity 0.1.0", "seed 1", tree.attrs["case"].strip(), *literature(tree)):
        assert fact in shown
    assert text.count("2026-01-02, 03:04 UTC") == 2
    assert "T03:04" not in text
    assert literature(tree)[0].startswith("asperity 0.1.0: ")
    assert len(literature(tree)) == 3
    assert "d₀" in text
    assert len(text) < 2_000_000
    printed = text[text.index("@media print") : text.index("</style>")]
    for rule in ("@page { size: A4;", ".case-file { max-height: none; overflow: visible; }",
                 "details:not(.numbers)::details-content { content-visibility: visible;"):  # fmt: skip
        assert rule in printed


def test_values_that_differ_from_the_default_are_marked(tree, text):
    parameters = json.loads(tree["scenario"].attrs["parameters"])
    changed = [p for p in parameters if not p["is_default"]]
    cells = r'<th scope="row">(.*?)</th><td><span class="value">(.*?)</span>'
    on_top, folded = text[text.index('id="case"') :].partition("</details>")[0].split("<details")
    shown = re.findall(rf"<tr>{cells}", on_top)
    assert sorted(shown) == sorted((p["key"], p["value"]) for p in changed)
    marked = re.findall(rf'<tr class="changed">{cells}', folded)
    assert sorted(marked) == sorted((p["key"].rpartition(".")[2], p["value"]) for p in changed)
    assert len(re.findall(cells, folded)) == len(parameters)
    said = html.unescape(on_top).replace("\u00a0", " ")
    assert all(f"default: {item['default']}" in said for item in changed)


@pytest.mark.parametrize(("changed", "told"), [
    (10, f"other than the defaults: {', '.join(f'k{n} = {n} m' for n in range(8))}, and 2 more"),
    (0, "All values are the defaults."),
])  # fmt: skip
def test_changes_are_counted_on_top(changed, told):
    tree = contact_only()
    items = [{"key": f"k{n}", "value": f"{n} m", "is_default": n >= changed} for n in range(changed or 3)]
    tree["scenario"].attrs["parameters"] = json.dumps(items)
    assert told in html.unescape(page_of(tree))


def test_hostile_text_stays_text():
    tree = small()
    parameter = dict.fromkeys(("key", "value", "default", "note"), HOSTILE) | {"is_default": False}
    names = ("title", "verdict", "case", "created", "asperity_version", "seed")
    tree.attrs.update(dict.fromkeys(names, HOSTILE))
    tree.attrs["citations"] = json.dumps([HOSTILE])
    tree.attrs["warnings"] = json.dumps([dict.fromkeys(("category", "message", "count"), HOSTILE)])
    tree["surface"].attrs.update(source=HOSTILE)
    tree["scenario"].attrs.update(
        kind=HOSTILE,
        parameters=json.dumps([parameter]),
        numerics=json.dumps([{"name": HOSTILE, "value": HOSTILE}]),
        laws=json.dumps([dict.fromkeys(spec_of("linear").entry(), HOSTILE), {"name": "linear"}, HOSTILE]),
    )
    statistic = dict.fromkeys(("symbol", "unit", "bandwidth", "surface", "meaning"), HOSTILE) | {"value": 1.0}
    tree["surface"].attrs["statistics"] = json.dumps([statistic])
    for group in ("rolling", "spectra"):
        tree[group] = tree[group].to_dataset().assign_coords(law=[HOSTILE, "linear"])
    page = page_of(tree)
    assert len(own_scripts(page)) == 3
    assert Reader(page).shown.count(HOSTILE) > 20


def test_characters_that_act_are_seen(tmp_path):
    """A name controls neither the terminal that a page is printed in nor the direction of what follows."""
    tree, acting, seen = small(), "a\x1b[31m\x07\u202eb", r"a\x1b[31m\x07\u202eb"
    tree.attrs.update(title=acting, case=acting)
    tree["surface"].attrs.update(source=acting)
    tree.attrs["warnings"] = json.dumps([{"category": "", "message": acting, "count": 1}])
    files = [file.read_text(encoding="utf-8") for file in report(tree, tmp_path).parent.iterdir()]
    assert sum(text.count(seen) for text in files) >= 3
    assert not any(set(text) & set(acting) - set("a[31mb") for text in files)


@pytest.mark.parametrize("attrs", [{}, {"warnings": "not JSON", "citations": "{}"}])
def test_damaged_or_missing_attributes_are_survived(attrs):
    tree = contact_only()
    tree.attrs = attrs
    for group in tree.children:
        tree[group].attrs = {}
    assert "No verdict was stored" in page_of(tree)


def test_nothing_is_drawn_or_written_for_what_is_left_out(tmp_path):
    tree = small(surface=["sample_heights", "psd_sample", "psd_path"], contact=["printed_filter", "pressure"])
    tree["contact"]["filter"] = tree["contact"]["filter"] * np.nan  # as if it were not there
    del tree["rolling"], tree["spectra"]
    page = report(tree, tmp_path, figures="svg")
    drawn = {"texture_path", "contact_force"}
    files = {f"{name}.{ending}" for name in drawn for ending in ("csv", "svg")}
    assert {file.name for file in tmp_path.iterdir()} == {"report.html", *files}
    assert set(Reader(page.read_text(encoding="utf-8")).all("id")) & set(PARTS) == drawn


def test_wrong_folders_and_formats_are_told(tmp_path):
    with pytest.raises(InputError, match="figures: received 'jpg'; allowed: svg, pdf, png"):
        report(contact_only(), tmp_path, figures="jpg")
    (tmp_path / "occupied").write_text("a file")
    with pytest.raises(ComputationError, match="could not be written"):
        report(contact_only(), tmp_path / "occupied")


def test_numbers_keep_their_units_on_the_line():
    tree = contact_only()
    tree.attrs["verdict"] = "It varies by 8.35 kN rms, −18.0 dB (3.15 kHz), 2.1 % of the time; 3 seconds"
    told = "8.35\u00a0kN rms, −18.0\u00a0dB (3.15\u00a0kHz), 2.1\u00a0% of the time; 3 seconds"
    assert told in page_of(tree)


def test_a_summary_holds_the_first_screen_and_three_figures(tree):
    reader = Reader(page_of(tree, summary=True))
    figures = [attrs["id"] for tag, attrs in reader.tags if tag == "figure"]
    assert figures == ["acceleration_sensors", "force_bands", "texture_psd"]
    assert "seed 1" in reader.shown
    assert "Literature" not in reader.shown
    assert set(json.loads(reader.scripts[0])["charts"]) == set(figures)


@pytest.mark.parametrize("converged", [False, True])
def test_the_command_that_remakes_it(converged):
    tree = contact_only()
    if converged:
        words = {name: ("setting", [name]) for name in ("setting", "change", "limit")}
        tree["convergence"] = xr.Dataset(words | {"law": ("law", ["areal"])})
    told = "asperity run case.toml" + (" --converge" if converged else "")
    assert f'<pre tabindex="0">{told}</pre>' in page_of(tree)


def test_a_case_with_a_map_in_memory_says_what_to_save_first():
    """The case of the page cannot be run as it stands."""
    plane = asperity.HeightMap(1e-7 * np.random.default_rng(1).normal(size=(40, 30)), 8e-6)
    case = asperity.BallOnBeam(surface={"file": plane})
    assert case.with_(surface={"file": None, "rms": 1e-6}).in_memory == {}
    tree = contact_only()
    tree.attrs |= root_attributes(case, "", [], "", [], {})
    again = page_of(tree).partition('id="remake"')[2].partition("<h3")[0]
    assert (
        "with <code>surface.file</code> in memory: height map of 40 × 30 points, 8 um × 8 um apart" in again
    )
    assert '<code>case.save("case.toml")</code>' in html.unescape(again)
    assert '<code>numpy.save("surface_file.npy", …)</code>' in html.unescape(again)
    assert "Then save the case below" in again


@pytest.mark.parametrize(
    ("laws", "unticked"),
    [
        (["areal", "shifted", "linear-filtered", "linear"], ["shifted", "linear"]),
        (["linear-filtered", "areal"], []),  # that of practice is the answer
        (["areal", "linear"], []),  # nothing to show beside it
    ],
)
def test_a_page_begins_with_the_main_law_and_that_of_practice(laws, unticked):
    tree = xr.DataTree()
    tree["scenario"] = xr.Dataset(attrs={"laws": json.dumps([spec_of(name).entry() for name in laws])})
    assert unticked_laws(tree) == unticked


# --- numbers in files and words


def said(tree):
    return PARTS["contact_force"].drawn(tree).caption


def test_caption_says_what_printed_owes_to_its_datum(tree):
    contact = tree["contact"].to_dataset()
    attrs = contact.attrs
    datum, load = attrs["datum"], attrs["working_load"]
    state = attrs["working_approach"] + datum
    tangent = np.interp(attrs["working_approach"], contact["approach"], contact["tangent_stiffness"])
    below, change = (
        20 * np.log10(tangent * state / load),
        20 * np.log10(state / (attrs["datum_path"] + state - datum)),
    )
    assert f"In printed k_c multiplies the texture: under the working load {below:.1f} dB" in said(tree)
    path, alone = (engineering(attrs[f"datum_{name}"], "m") for name in ("path", "samples"))
    assert f"d₀ from samples and path, {path}, would change that by −{-change:.1f} dB." in said(tree)
    assert "In printed" not in said(small())
    other = report_tree()
    other["contact"].attrs["datum"] = attrs["datum_path"]
    assert f"d₀ from the samples alone, {alone}, would change that by +" in said(other)


@pytest.mark.parametrize(
    ("value", "unit", "shown"),
    [(3.1e-7, "m", "310 nm"), (1.5e-6, "m", "1.50 µm"), (-0.41, "1", "−0.41"), (2.4e8, "Pa", "240 MPa"),
     (0.0, "J", "0 J"), (-0.0, "m", "0 m"), (3.1e-8, "m²", "0.0310 mm²"),
     (float("nan"), "m", "–"), (0.05, "m", "50.0 mm"), (5.04, "N", "5.04 N")],
)  # fmt: skip
def test_numbers_are_written_with_prefixes(value, unit, shown):
    assert engineering(value, unit) == shown


def test_bands_have_their_nominal_names():
    """IEC 61260-1, table of nominal frequencies."""
    names = "25 31.5 40 50 63 80 100 125 160 200 250 315 400 500 630 800 1k 1.25k 1.6k 2k 2.5k 3.15k 4k 5k"
    assert [nominal_band(1000 * 10 ** (n / 10)) for n in range(-16, 8)] == names.split()
    assert power_of_ten(1e-16) == "10⁻¹⁶"


def test_long_lines_keep_their_extremes_and_their_level():
    signal = np.sin(np.arange(10_000) * 0.37)
    signal[1234], signal[8765] = 9.0, -7.0
    starts, low, high = envelope(signal, 300)
    assert (len(starts), low.min(), high.max()) == (300, -7.0, 9.0)
    assert envelope(signal[:20], 300)[1].tolist() == signal[:20].tolist()
    frequency = np.arange(1.0, 5001.0)
    smooth, psd = smooth_on_log_axis(frequency, np.full(5000, 3.0))
    assert np.allclose(psd, 3.0, rtol=1e-12)
    assert np.array_equal(smooth[:10], frequency[:10])
    assert len(smooth) < 300


# --- the range of validity

CHECK = {"value": "0.31", "limit": "from 0.9 on", "meaning": "It is rough.", "remedy": "Take table."}
NOT_KNOWN = "not known: run with --converge (limit: up to 0.5 dB)"


def told_lights(tree):
    """Sentence on top, and of each light its class, its shape and its words."""
    text = page_of(tree)
    block = text[text.index('<details class="checks') :].partition("</details>")[0].replace("\u00a0", " ")
    rows = re.findall(r'<li class="(\w+)"><span class="light" aria-hidden="true">(.)</span>(.*?)</li>', block)
    sentence = re.sub("<.*?>", "", block[block.index("<summary>") : block.index("</summary>")])
    return sentence, [(look, shape, re.sub("<.*?>", "", told)) for look, shape, told in rows]


def test_checks_and_warnings_are_one_list_the_gravest_first():
    """A warning that a check says as well stands once."""
    grades = {"area: 0.31, in range from 0.9 on. It is rough.": "out of range", "two of them": "warning",
              "one more": "warning", "hardly any": "note"}  # fmt: skip
    kind = "OutOfRangeWarning"
    told = [{"category": kind, "message": m, "grade": g, "count": 1} for m, g in grades.items()]
    told[1]["count"] = 2
    tree = contact_only(warnings=told)
    checks = {"area": "out of range", "slope": "warning", "cells": ""}
    found = [CHECK | {"quantity": quantity, "grade": grade} for quantity, grade in checks.items()]
    tree["contact"].attrs["validity"] = json.dumps(found)
    sentence, rows = told_lights(tree)
    counts = "1 out of range, 3 warnings, 1 note, 1 of 6 checks in range, 1 not checked."
    assert sentence == f"■ Out of range: {counts}"
    assert [told for _, _, told in rows] == [
        "out of range · area: 0.31 (limit: from 0.9 on) It is rough. Take table.",
        "warning · Two of them: 2 times",
        "warning · One more",
        "warning · slope: 0.31 (limit: from 0.9 on) It is rough. Take table.",
        "note · Hardly any",
        f"not checked · change of levels by finer settings: {NOT_KNOWN}",
        "in range · cells: 0.31 (limit: from 0.9 on)",
    ]
    assert len({shape for _, shape, _ in rows}) == 4  # two of five look alike but for their colour
    assert "OutOfRangeWarning" not in page_of(tree)  # names of classes say nothing to people


@pytest.mark.parametrize(("grade", "sentence"), [
    ("", "● Valid: the one check in range, 1 not checked."),
    ("note", "● Valid: 1 note, 1 not checked."),
    ("warning", "▲ To be read with care: 1 warning, 1 not checked."),
])  # fmt: skip
def test_one_sentence_says_whether_it_is_valid(grade, sentence):
    tree = contact_only(warnings=[])
    tree["contact"].attrs["validity"] = json.dumps([CHECK | {"quantity": "area", "grade": grade}])
    assert told_lights(tree)[0] == sentence


def with_expected(error, low, high, off_map=False):
    tree = small()
    found = {"law": "areal", "error": error, "low": low, "high": high}
    told = {"errors": [found], "taken": "areal", "off_map": off_map, "wanted": 1.0}
    tree["scenario"].attrs["expected_errors"] = json.dumps(told)
    return tree


@pytest.mark.parametrize(("band", "off_map", "state"), [
    ((0.5, 0.3, 0.8), False, "in range"),
    ((0.5, 0.3, 1.2), False, "note"),
    ((1.4, 0.9, 2.0), False, "warning"),
    ((0.5, 0.3, 0.8), True, "note"),
])  # fmt: skip
def test_the_expected_error_of_the_law_has_a_light(band, off_map, state):
    (light,) = [each for each in lights(with_expected(*band, off_map)) if "from direct" in each.quantity]
    assert (light.state, light.limit) == (state, "up to 1 dB")
    assert light.value.startswith(f"{band[0]} dB ({band[1]} to {band[2]})")
    assert ("guess" in light.value) == off_map


@pytest.mark.parametrize(("chance", "state"), [(1.0, "out of range"), (30.0, "warning")])
def test_a_setting_that_changes_levels_by_many_decibels_is_out_of_range(chance, state):
    """But for a path that is chaos: half of it is then as far from all of it."""
    tree, names = contact_only(), ["poles", "grid", "path length"]
    columns = dict.fromkeys(("setting", "change"), names) | {"limit": [""] * 3}
    columns |= {"largest_change": [31.94, 0.1, chance], "largest_band": [1e3] * 3}
    columns["stiffness_change"] = [0.0] * 3
    group = xr.Dataset({name: ("setting", values) for name, values in columns.items()})
    tree["convergence"] = group
    found = {light.quantity.rpartition(" ")[2]: light.state for light in lights(tree)}
    assert (found["poles"], found["grid"]) == (state, "in range")
    assert sentence(group, "areal").startswith("Not converged: poles is too coarse") == (state != "warning")


def test_what_is_known_of_the_uncertainty_is_listed():
    tree = with_expected(0.5, 0.3, 0.8)
    spectra = (tree[f"spectra/{name}"].values for name in ("band", "band_time_product", "level_deviation"))
    bands, product, deviation = spectra
    product *= 10.0
    held = np.zeros(bands.size)
    held[np.flatnonzero(product >= 10.0)[1]] = 0.499  # half of the mean square
    tree["spectra"]["start_share"] = xr.Variable("band", held)
    told = np.flatnonzero((bands < 5500) & (product >= 10.0))
    ends = [f"{deviation[i]:.1f} dB at {nominal_frequency(bands[i])}" for i in (told[-1], told[0])]
    assert {row[0].text: row[1].text for row in uncertainty_table(tree).rows} == {
        "the law areal, against direct": "0.5 dB (0.3 to 0.8)",
        "chance: one record of this length": " to ".join(ends),
        "start of the record": f"up to 3.0 dB low, at {nominal_frequency(bands[told[1]])}",
    }


# --- what is said first


def test_numbers_of_the_main_law_come_first():
    wave = np.sin(2 * np.pi * np.arange(1000) / 100)
    force, loss = force_answers(with_force(40 + 10 * wave, 40 + wave)).numbers
    assert (force.value, force.note) == ("7.07 N", "17.7 % of its mean of 40.0 N; at most 50.0 N")
    assert (loss.value, loss.note) == ("0 %", "contact is never lost")
    flying = with_force(np.maximum(10 * wave, 0.0))
    assert force_answers(flying).numbers[1].value == f"{100 * (wave <= 0).mean():.1f} %"


def test_numbers_of_several_contacts_are_of_all_of_them(real_runs):
    """A bogie's tile had the forces of its first contact, at most 85.5 kN, where the second had 89.1."""
    tree = real_runs["bodies"].copy(deep=True)
    wave = np.sin(np.linspace(0.0, 40.0 * np.pi, tree["rolling"].sizes["time"]))
    forces, losses = tree["rolling/contact_force"], tree["rolling/contact_loss_share"]
    forces.values[0] = np.stack([40.0 + 10.0 * wave, 60.0 + 20.0 * wave])
    losses.values[0] = 0.0, 0.25
    force, loss = force_answers(tree).numbers
    assert force.name == "forces of 2 contacts vary by, rms"
    assert force.value == engineering(np.sqrt(0.5 * (10.0**2 + 20.0**2) * np.mean(wave**2)), "N")
    assert force.note.endswith("of their mean of 50.0 N; at most 80.0 N at contact 2")
    assert (loss.value, loss.note[-12:]) == ("25.0 %", "at contact 2")
    for name in ("force_peak", "force_envelope", "force_bands", "force_psd"):
        assert (
            "Of contact 1 of 2; the others are in the chapter All contacts."
            in PARTS[name].drawn(tree).caption
        )


def test_the_most_shaken_sensor_is_named_with_the_bands_that_hold_half_of_it():
    tree = report_tree(LAWS[:2])
    acceleration, level = tree["rolling/acceleration"], tree["spectra/acceleration_level"]
    acceleration.values[0] = 0.1
    acceleration.values[0, 1] = -3.0
    level.values[0] = 20.0
    level.values[0, 1, [4, 5, 9]] = 120.0, 121.0, 119.0
    answers = acceleration_answers(tree)
    place, bands = float(tree["rolling/sensor"][1]), tree["spectra/band"].values
    low, high = (nominal_frequency(float(bands[i])) for i in (4, 5))
    assert answers.lead == (
        f"The structure vibrates most at x = {place:g} m: 3.00 m/s² rms, half of its energy in the bands of "
        f"{low} to {high}."
    )
    weighted = 10 * np.log10(np.sum(10 ** ((level.values[0, 1] + a_weighting(bands)) / 10)))
    assert answers.tables[0].rows[1][2].text == f"{weighted:.1f}"
    assert answers.lead in Reader(page_of(tree)).shown


@pytest.mark.parametrize(("levels", "told"), [
    ([60.0, 66.0, np.nan, 60.0, 66.0, 60.0], "bands of 630 Hz and 1.25 kHz"),
    ([0.0, 70.0, 70.0, 70.0, 0.0, 0.0], "bands of 630 Hz to 800 Hz"),
    ([0.0, 0.0, 0.0, 70.0, 0.0, 0.0], "band of 1 kHz"),
    ([70.0, 66.0, 66.0, 66.0, 60.0, 60.0], "bands of 500 Hz to 630 Hz"),  # 10 + 4 of 24
])  # fmt: skip
def test_deciding_bands_are_the_fewest_that_hold_half(levels, told):
    assert deciding_bands(1000 * 10 ** (np.arange(-3, 3) / 10), np.array(levels)) == f"the {told}"
