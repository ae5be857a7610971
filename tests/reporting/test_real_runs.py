"""Pages of real runs of each kind: whole, by themselves, their numbers exact, and what lacks left out.

None bars anybody, nor does any other page that is made of runs.
"""

import json
import re
from contextlib import contextmanager

import numpy as np
import pytest
from report_reading import Reader, computers_exponents, own_scripts, without
from report_tree import PARTS

from asperity import BallBearing
from asperity.reporting import data
from asperity.reporting.figure import columns_text
from asperity.reporting.page import answers_of
from asperity.reporting.payload import charts_json
from asperity.results import read_result, save
from asperity.scenes.report import CHAPTERS, compare, figures_of, page_of, report, write_summary
from asperity.written_numbers import engineering
from browser import assert_accessible, pages_of, shared_page
from command_line import call
from small_cases import BEARING, CASES, changed

TABLES = {
    "ball-on-beam": {"statistics", "contact_loss", "energy_balance"},
    "wheel-on-rail": {"statistics", "contact_loss", "sound_power"},
    "bodies": {"statistics", "contact_loss", "where_contacts_are", "energy_balance"},
}


def kind_of(tree):
    return tree["scenario"].attrs["kind"]


@pytest.fixture
def folder(real_run, reports):
    return reports[kind_of(real_run)]


@pytest.fixture
def text(folder):
    return (folder / "report.html").read_text(encoding="utf-8")


def test_page_loads_nothing_and_its_links_lead_somewhere(text, folder):
    assert len(own_scripts(text)) == 3
    assert not re.search(r"https?:", text)
    files = [target for target in Reader(text).all("href") if target.endswith(".csv")]
    assert all((folder / target).is_file() for target in files)


def test_all_figures_tables_and_numbers_are_there(real_run, text, folder):
    kind, names = kind_of(real_run), set(Reader(text).all("id"))
    drawn = {part.name for part in figures_of(real_run)}
    chapters = {c.name for c in CHAPTERS if drawn & {part.name for part in c.figures}}
    assert ("where_contacts_are" in names) == ("where_contacts_are" in TABLES[kind])  # one is no list
    assert drawn | chapters | TABLES[kind] | {"case", "literature", "remake", "provenance"} <= names
    assert {path.name for path in folder.iterdir()} == {"report.html", *(f"{name}.csv" for name in drawn)}


def test_no_number_is_written_as_a_computer_does(real_run, text):
    """The residual of the energy read 3.0e-08; heads of numbers y=-8e-05 m."""
    assert computers_exponents(text) == []
    assert computers_exponents(page_of(real_run, summary=True)) == []


def test_what_the_run_says_is_shown(real_run, text):
    shown, scenario = Reader(text).shown, real_run["scenario"].attrs
    assert real_run.attrs["verdict"] in shown
    assert all(warning["message"][1:] in shown for warning in json.loads(real_run.attrs["warnings"]))
    for citation in json.loads(real_run.attrs["citations"]):
        key, _, origin = citation.partition(": ")
        assert citation in shown or (key in shown and origin in shown)
    items = json.loads(scenario["numerics"]) + json.loads(scenario["parameters"])
    assert all(item["value"] in shown for item in items)


def test_result_read_back_from_its_file_has_the_same_numbers(real_run, tmp_path):
    read = read_result(save(real_run, tmp_path / "run.nc"))
    for one, other in zip(figures_of(read), figures_of(real_run), strict=True):
        assert (one.name, one.caption) == (other.name, other.caption)
        assert columns_text(one.columns) == columns_text(other.columns)


def test_what_lacks_all_attributes_has_all_figures(real_run):
    bare = real_run.copy()
    for group in bare.children:
        bare[group].attrs = {}
    assert [part.name for part in figures_of(bare)] == [part.name for part in figures_of(real_run)]


def read_by(part, tree):
    """A figure of a result, if it has it, and the variables that it asks for, by group and name."""
    read, stored = set(), data._is_stored

    def asked(tree, entry):
        read.add((entry.group, entry.name))
        return stored(tree, entry)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(data, "_is_stored", asked)
        return data.unless_missing(part.drawn, tree), read


def shown(figure):
    """What is drawn, said and written of a figure, if there is one."""
    return figure and (charts_json({"": figure.chart}, {}), figure.caption, columns_text(figure.columns))


@contextmanager
def lacking(tree, group, name):
    """A result lacks a variable for a while."""
    node = tree[group]
    node.dataset = (whole := node.to_dataset(inherit=False)).drop_vars(name)
    yield tree
    node.dataset = whole


def test_what_lacks_a_variable_is_left_out_and_all_others_stay(real_run):
    """A figure is the same without what it never asks for, and made or left out without each of the rest."""
    held = {(group, str(name)) for group, of in real_run.children.items() for name in of.data_vars}
    tree = real_run.copy()
    for part in PARTS.values():
        drawn, read = read_by(part, real_run)
        alone = data.unless_missing(part.drawn, without(real_run, *(held - read)))
        assert shown(alone) == shown(drawn), part.name
        needed = {(entry.group, entry.name) for entry in part.needs}
        for variable in held & read:
            with lacking(tree, *variable):
                left = data.unless_missing(part.drawn, tree)
            assert left is None or (drawn and variable not in needed), (part.name, variable)


@pytest.mark.parametrize("group", ["scenario", "surface", "track", "contact", "rolling", "spectra"])
def test_one_group_alone_makes_a_page(real_run, group):
    tree = real_run.copy()
    for other in set(tree.children) - {group}:
        del tree[other]
    assert "</html>" in page_of(tree)


NUMBER = r"(−?[\d.]+) ?([mk]?N|%)"


def in_si(words):
    """A force, N, or a share, as it is written."""
    number, unit = re.fullmatch(NUMBER, words.replace("\u00a0", " ")).groups()
    return float(number.replace("−", "-")) * {"mN": 1e-3, "N": 1.0, "kN": 1e3, "%": 0.01}[unit]


def test_tiles_verdict_and_table_of_a_page_are_of_all_contacts_of_the_main_law(real_run):
    """Each number of the top is computed here anew, from the forces that the result holds."""
    tiles = {each.name.partition(" ")[0]: each for each in answers_of(real_run, CHAPTERS).numbers}
    force = real_run["rolling/contact_force"].values[0]
    rms = np.sqrt(np.mean(np.var(force, axis=-1)))
    name = "contact" if len(force) == 1 else "forces"
    said = [tiles[name].value, *(f"{n} {unit}" for n, unit in re.findall(NUMBER, tiles[name].note))]
    for words, number in zip(said, [rms, rms / force.mean(), force.mean(), force.max()], strict=True):
        assert in_si(words) == pytest.approx(number, rel=6e-3, abs=6e-4)
    verdict = real_run.attrs["verdict"]
    told = re.search(rf"contact forces? var(?:y|ies) by ({NUMBER}) rms", verdict)
    assert in_si(told[1]) == pytest.approx(rms, rel=6e-3)
    lost = real_run["rolling/contact_loss_share"].values[0].max()
    never = re.search("never loses|is ever lost", verdict) is not None
    assert never == (lost == 0.0) == (tiles["time"].note == "contact is never lost")
    assert in_si(tiles["time"].value) == pytest.approx(lost, rel=0.1)
    if "vibration," in tiles:
        shaken = np.sqrt((real_run["rolling/acceleration"].values[0] ** 2).mean(axis=-1))
        assert f"{engineering(shaken.max(), 'm/s²')} rms, half" in answers_of(real_run, CHAPTERS).lead


def test_a_law_that_may_pull_is_said_to_lose_no_contact_everywhere(runs):
    """The tile said that it cannot be lost, the verdict that none ever was."""
    tree = runs(changed("bodies", laws=["linear"]))
    assert tree.attrs["verdict"].startswith("By linear no contact can be lost: its force may pull; ")
    (tile,) = (each for each in answers_of(tree, CHAPTERS).numbers if each.name == "time without contact")
    assert tile.note == "linear cannot lose it: its force may pull"
    assert "What the choice of the contact law changes" not in page_of(tree)


# --- nothing bars anybody: the rules of axe-core


def page_of_a_study(folder, sweep):
    """Write the page of a study of a smooth ball."""
    (folder / "study.toml").write_text(f"[case]\n{SMOOTH}\n[sweep]\n{sweep}\n")
    call("study", str(folder / "study.toml"), "-o", str(folder), "--workers", "1")
    return folder / "study.html"


SMOOTH = """kind = "ball-on-beam"
laws = ["hertz", "linear"]
start = "0.45 m"
duration = "20 ms"
settling = "0 s"
surface.spectrum = "iso3095"
"""
SWEEPS = {
    "study of speeds": 'speed = ["0.9 m/s", "1 m/s", "1.1 m/s"]',
    "study over seeds": 'speed = ["0.9 m/s", "1.1 m/s"]\nseed = [1, 2, 3]',
    "what helps": '[sweep.variant."calm"]\nsurface.level = "minus 30 dB"',
}
BEARINGS = "ball-bearing"


@pytest.fixture
def page(request, real_runs, reports, runs, tmp_path):
    """A page of a kind that is named."""
    what, _, kind = request.param.partition(" of ")
    if request.param in SWEEPS:
        return page_of_a_study(tmp_path, SWEEPS[request.param])
    if what == "comparison":
        ball, bogie = real_runs["ball-on-beam"], real_runs["bodies"]
        compare(ball, bogie, names=["ball", "bogie"], path=tmp_path)
        return tmp_path / "comparison.html"
    result = runs(BEARING) if kind == BEARINGS else real_runs[kind]
    if what == "summary":
        return write_summary(result, tmp_path / "summary.html")
    return report(result, tmp_path) if kind == BEARINGS else reports[kind] / "report.html"


KINDS = (*CASES, BEARINGS)
PAGES = [f"{what} of {kind}" for what in ("run", "summary") for kind in KINDS]


@pytest.mark.parametrize("page", [*PAGES, "comparison", *SWEEPS], indirect=True)
def test_nothing_bars_anybody(browser, members_in_this_process, own_cache, page):
    """With all that is folded open; on a phone everything that is wider scrolls in itself.

    Pages of `asperity serve` are looked at in ``serving``, that of an optimisation in ``optimising``.
    """
    with pages_of(browser, page.as_uri()) as opened:
        shown = opened(390, "dark")
        assert shown.evaluate("document.documentElement.scrollWidth") <= 390
        assert_accessible(shown)


LONG = """() => { for (const each of document.querySelectorAll(".numbers dd.big"))
  each.textContent = "0.000101\u00a0µm/s"; }"""


def test_long_numbers_at_the_head_of_a_page_are_no_wider_than_a_phone(browser, runs, tmp_path):
    shown = shared_page(browser, 390)
    shown.goto(report(runs(BEARING), tmp_path).as_uri())
    assert shown.locator(".numbers dd.big").count() > 2
    shown.evaluate(LONG)
    assert shown.evaluate("document.documentElement.scrollWidth") <= 390


# --- data sheets of bearings


def cells_of(path):
    """Words of all cells of a page, and its text."""
    text = path.read_text(encoding="utf-8").replace("\u00a0", " ")
    return re.findall(r"<td[^>]*>(.*?)</td>", text), text


def test_the_sheet_of_a_bearing_has_its_geometry_stiffness_and_tones(tmp_path):
    sheet = tmp_path / "7205C.html"
    words = ("bearing", "7205C", "--radial", "60 N", "--axial", "200 N", "--speed", "6000 1/min")
    document = json.loads(call(*words, "--sheet", str(sheet), "--json").stdout)
    assert document["files"] == {"sheet": str(sheet.resolve())}
    cells, text = cells_of(sheet)
    bearing = BallBearing.named("7205C")
    found = bearing.loaded(60.0, 200.0, speed=100.0)
    assert {"12 of 7.94 mm, steel", "25 × 52 × 15 mm", "15°"} <= set(cells)
    turning = bearing.kinematics(100.0, contact_angle=found.contact_angle)
    assert f"{turning.ball_pass_outer:.2f}" in cells
    assert f"{turning.ball_pass_inner / 100.0:.4f}" in cells
    assert "60 N radially, 200 N axially at 6000 1/min" in text
    stiffness = found.stiffness[:, 2, 2].mean()
    half = bearing.loaded(30.0, 100.0, speed=100.0).stiffness[:, 2, 2].mean()
    table = text[text.index("Stiffness over load</h3>") : text.index("Tones</h3>")]
    plain = str.maketrans("⁶⁷⁸⁹", "6789")
    rows = [cell.translate(plain).replace("·10", "e") for cell in re.findall(r"<td[^>]*>(.*?)</td>", table)]
    loads, _, _, axially = np.array(rows, dtype=float).reshape(-1, 4).T
    at = [np.interp(np.log(load), np.log(loads), axially) for load in np.hypot([60, 30], [200, 100])]
    assert at == pytest.approx([stiffness, half], rel=5e-3)
    assert "SNFA E 225" in text
    assert own_scripts(text)


def test_the_sheet_of_a_run_has_its_bands_by_part(runs, tmp_path):
    result = runs(BEARING)
    save(result, tmp_path / "run.nc")
    call("bearing", str(tmp_path), "--sheet", str(tmp_path / "run.html"))
    cells, text = cells_of(tmp_path / "run.html")
    assert "Velocities in the bands of ISO 15242-2" in text
    assert any("alone" in cell for cell in cells)
    said = call("bearing", "6205", "--radial", "9 N", "--sheet", "a.pdf", code=2).stderr
    assert "--sheet: received 'a.pdf'; allowed: a name that ends in .html" in said
    assert (
        "--sheet: received a signal"
        in call("bearing", "6205", "--sheet", "a.html", "-o", "b.png", code=2).stderr
    )
