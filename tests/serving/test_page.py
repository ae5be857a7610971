"""The page in a real browser: contacts pressed, surfaces refused, runs rolled, cancelled, kept."""

import http.client
import signal
import subprocess
import sys
import time
from contextlib import closing, suppress
from urllib.parse import urlsplit

import numpy as np
import psutil
import pytest

from browser import assert_accessible, shared_page
from small_cases import BALL

pytest.importorskip("starlette", reason="the extra app is not installed")
pytest.importorskip("uvicorn", reason="the extra app is not installed")

import asperity
from asperity.case.cases import as_case, read_case
from asperity.case.toml import toml_text
from asperity.reporting.sound import listen
from asperity.results import save
from asperity.serving.stored_runs import keep_run

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="the server is ended by signals")

SMALL = BALL | {"laws": ["shifted"], "duration": "10 ms"}
PATIENCE = 60_000
"""Time that anything may take on a machine that does other things beside it, ms."""
FORGET = "localStorage.clear(), sessionStorage.clear(), location.replace('about:blank')"
"""What a tab keeps is for the test that opened it."""


class Served:
    """The program as a user starts it."""

    def __init__(self, folder):
        self.folder = folder
        self.start()

    def start(self):
        self.process = subprocess.Popen(
            [sys.executable, "-m", "asperity", "serve", "-o", str(self.folder)],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        self.address = self.process.stdout.readline().split()[-1]
        self.port = urlsplit(self.address).port

    def end(self, number=signal.SIGINT):
        """End it; its exit code and all it said on standard error."""
        self.process.send_signal(number)
        _, told = self.process.communicate(timeout=60)
        return self.process.returncode, told

    def ask(self, path, method="GET", **headers):
        """Status and text of an answer, without a browser."""
        with closing(http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)) as connection:
            connection.request(method, path, headers=headers)
            found = connection.getresponse()
            return found.status, found.read().decode()


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    found = Served(tmp_path_factory.mktemp("page") / "kept")
    yield found
    assert found.end(signal.SIGTERM)[0] == 0


@pytest.fixture
def tab(browser, served):
    """A tab with the page, whose script has met no error."""
    opened, wrong = shared_page(browser, height=900), []
    opened.context.set_default_timeout(PATIENCE)
    heard = {
        "pageerror": lambda error: wrong.append(str(error)),
        "console": lambda message: wrong.append(message.text) if "Policy" in message.text else None,
    }
    for event, hear in heard.items():
        opened.on(event, hear)
    opened.goto(served.address)
    opened.wait_for_selector("body[data-first-picture]")
    yield opened
    opened.evaluate(FORGET)
    opened.wait_for_url("about:blank")
    for event, hear in heard.items():
        opened.remove_listener(event, hear)
    assert wrong == []


def fill(tab, tmp_path, case):
    """Open a case file in the form, and wait for its contact."""
    file = tmp_path / "case.toml"
    file.write_text(toml_text(case))
    before = tab.evaluate("document.body.dataset.answers")
    tab.set_input_files("#case-file", file)
    tab.wait_for_function("before => document.body.dataset.answers !== before", arg=before)


def roll(tab, name):
    """Roll the case of the form, and return the row of the run."""
    tab.fill("#run-name", name)
    tab.click("#roll")
    return tab.locator("#run-list li", has_text=name)


def becomes(tab, name, state):
    tab.wait_for_selector(f"#run-list li[data-state={state}]:has-text('{name}')")


@pytest.fixture(scope="module")
def kept(served):
    """Folder of a run of a body that is done, as an earlier server left it."""
    runs, case = served.folder / "runs", as_case(SMALL)
    folder = runs / keep_run(runs, case.to_toml(), kind="ball-on-beam", name="a run", changed="")
    tree = asperity.run(case)
    listen(tree, folder / "sounds")
    save(tree, folder / "run.nc")
    return folder


def number(tab, what):
    """A number of the contact with its unit, as the page shows it."""
    return tab.locator("#contact-numbers div", has_text=what).locator("dd").inner_text()


def move(tab, slider, value):
    """Move a slider, and wait for the contact."""
    before = tab.evaluate("document.body.dataset.answers")
    moved = "(it, value) => { it.value = value; it.dispatchEvent(new Event('input', { bubbles: true })); }"
    slider.evaluate(moved, value)
    tab.wait_for_function("before => document.body.dataset.answers !== before", arg=before)


def slide(tab, what, steps):
    """Move a slider of the form from the middle by hundredths of a tenfold."""
    move(tab, tab.locator("#sliders label", has_text=what).locator("input"), steps)


def test_pressure_and_stiffness_follow_the_slider(tab):
    assert number(tab, "force F") == "50.0 N"  # that of the template
    seen = []
    for share in (0.2, 0.9):
        move(tab, tab.locator("#approach"), 1000 * share)
        pixels = tab.evaluate("document.getElementById('pressure').toDataURL()")
        seen.append((number(tab, "k_c = F/r"), number(tab, "force F"), pixels))
    assert len({*seen[0], *seen[1]}) == 6
    tab.click("#to-load")
    tab.wait_for_function("() => document.querySelector('#contact-numbers').textContent.includes('50.0 N')")


def hertz(words):
    return float(words.split()[0]) * {"Hz": 1, "kHz": 1e3}[words.split()[1]]


def test_the_contact_follows_load_roughness_and_speed_and_a_reload_keeps_them(tab):
    passing, pressure = number(tab, "waves of its length"), number(tab, "largest pressure")
    slide(tab, "Speed", 30)
    assert hertz(number(tab, "waves of its length")) == pytest.approx(2 * hertz(passing), rel=5e-3)
    slide(tab, "Roughness", 50)
    assert float(number(tab, "largest pressure").split()[0]) > 1.1 * float(pressure.split()[0])
    slide(tab, "Load", -30)
    assert number(tab, "force F") == "25.1 N"
    tab.reload()
    tab.wait_for_selector("body[data-first-picture]")
    kept = {name: tab.input_value(f"input[name='{name}']:visible") for name in ("speed", "surface.rms")}
    assert kept == {"speed": "2 m/s", "surface.rms": "0.316 um"}
    assert number(tab, "force F") == "25.1 N"


def test_a_wrong_value_is_said_beside_its_field(tab):
    tab.fill("input[name='speed']", "fast")
    wrong = tab.locator(".case-form:not([hidden]) .field[data-key=speed] .wrong")
    wrong.wait_for(state="visible")
    assert "received 'fast'; allowed: a speed" in wrong.inner_text()
    assert tab.get_attribute("input[name='speed']", "aria-invalid") == "true"
    tab.click("#roll")
    assert tab.locator("#run-list li").count() == 0
    tab.fill("input[name='speed']", "2 m/s")
    wrong.wait_for(state="hidden")


def test_a_bad_upload_is_refused_and_a_good_one_is_pressed(tab, served, tmp_path):
    bad = tmp_path / "broken.x3p"
    bad.write_bytes(b"PK\x03\x04 this is no archive")
    tab.set_input_files("#surface-file", bad)
    tab.wait_for_selector("#upload-state.alert")
    assert "broken.x3p: received a zip archive without its directory" in tab.inner_text("#upload-state")
    assert list((served.folder / "surfaces").iterdir()) == []
    heights = 1e-1 * np.random.default_rng(1).normal(size=(120, 120)).cumsum(axis=0)
    good = tmp_path / "good.txt"
    good.write_text("# pixel: 8 um\n# z (um)\n" + "\n".join(" ".join(map(str, row)) for row in heights))
    tab.set_input_files("#surface-file", good)
    tab.wait_for_selector("#upload-state:not(.alert):has-text('map of 120 × 120 points')")
    tab.wait_for_selector("#contact-note:has-text('1 sample measured, good.txt')")


def test_without_the_token_there_is_nothing(served):
    path = urlsplit(served.address).path
    status, words = served.ask(f"{path[:-3]}/ask/runs")
    assert (status, "token" in words) == (403, True)
    for away in ("runs/../../../etc/passwd", "runs/%2e%2e/x/run.nc", "../case_form.py", "case_form.py"):
        assert served.ask(f"{path}{away}")[0] == 404


@pytest.mark.long
def test_two_tabs_reload_cancel_and_go_on(tab, served, tmp_path):
    fill(tab, tmp_path, SMALL)
    other = tab.context.new_page()
    other.goto(served.address)
    other.wait_for_selector("body[data-first-picture]")
    assert other.input_value("input[name='ball.load']") == "30 N"  # begins with the last one,
    slide(other, "Load", 10)  # and has its own from there on
    roll(tab, "first")
    becomes(other, "first", "running")
    tab.reload()
    becomes(tab, "first", "running")
    assert tab.input_value("input[name='ball.load']") == "30 N"
    other.click("button[aria-label='Cancel: first']")
    becomes(tab, "first", "cancelled")
    tab.click("button[aria-label='Go on: first']")
    becomes(tab, "first", "done")
    becomes(other, "first", "done")
    other.close()


def test_a_run_is_watched_heard_compared_and_taken_away(kept, tab, tmp_path):
    fill(tab, tmp_path, SMALL | {"beam": {"loss_factor": 0.02}})
    roll(tab, "<b>second</b>")
    tab.wait_for_selector("#rolled progress")  # where Roll was pressed
    tab.wait_for_selector("#rolled a:has-text('<b>second</b> is done')")
    tab.wait_for_selector("#watch:not([hidden])")
    assert tab.locator("#run b").count() == 0
    before = tab.inner_text("#now")
    tab.click("#play")
    tab.wait_for_function("before => document.getElementById('now').textContent !== before", arg=before)
    tab.click("#play")
    tab.locator("#player").evaluate("it => { it.preload = 'metadata'; }")
    tab.wait_for_function("() => document.getElementById('player').duration > 0.01")  # it is a sound
    assert tab.evaluate("document.getElementById('player').loop")  # of 10 ms
    tab.wait_for_selector("#force_bands.ready .plot canvas")
    with tab.expect_download() as taken:
        tab.click("text=Download run.nc")
    result = asperity.open_result(taken.value.path())
    with tab.expect_download() as taken:
        tab.click("text=Download the case")
    (tmp_path / "taken.toml").write_bytes(taken.value.path().read_bytes())
    assert read_case(tmp_path / "taken.toml").beam.loss_factor == 0.02
    shown = float(number(tab, "largest pressure").split()[0]) * 1e6  # of the sample that the run shows
    assert shown == pytest.approx(float(result["contact/pressure"].max()), rel=5e-3)
    for box in tab.locator("#run-list input[type=checkbox]").all()[:2]:
        box.check()
    tab.click("#compare")
    tab.wait_for_selector("#comparison #force_level.ready .plot canvas")
    words = tab.inner_text("#comparison")
    assert "beam.loss_factor" in words
    assert "0.02" in words
    assert "dB(A)" in words
    assert "#compare=" in tab.url  # it has an address, which opens it again
    tab.reload()
    tab.wait_for_selector("#comparison #force_level.ready .plot canvas")
    assert tab.inner_text("#comparison-words") in words
    tab.evaluate("location.hash = ''")  # as Back to where one began
    tab.wait_for_selector("#comparison", state="hidden")
    tab.go_back()
    tab.wait_for_selector("#comparison:not([hidden])")


def test_a_bearing_is_run_and_heard(tab, tmp_path):
    three = {
        "balls": 3, "ball_diameter": "7.94 mm", "pitch_diameter": "39.04 mm", "contact_angle": "20 deg"
    }  # fmt: skip
    waves = {"waves": [4], "amplitudes": ["20 nm"]}
    case = {
        "kind": "ball-bearing", "axial": "60 N", "speed": "18000 1/min", "duration": "20 ms",
        "settling": "1 ms", "laws": ["linear"], "bearing": three, "inner_raceway": waves,
    }  # fmt: skip
    fill(tab, tmp_path, case)
    roll(tab, "three balls")
    becomes(tab, "three balls", "done")
    tab.wait_for_selector("#load_zone.ready .plot canvas")
    tab.locator("#player").evaluate("it => { it.preload = 'metadata'; }")
    tab.wait_for_function("() => document.getElementById('player').duration > 0.01")
    with tab.expect_download() as taken:
        tab.click("text=Download run.nc")
    heard = asperity.open_result(taken.value.path())["bearing/band_velocity"].values
    assert heard[0, 0, 1] > 1e-6


def test_back_closes_a_run(kept, tab):
    tab.click(f"#run-list a[href='#run={kept.name}']")
    tab.wait_for_selector("#run:not([hidden])")
    tab.go_back()
    tab.wait_for_selector("#run", state="hidden")
    tab.go_forward()
    tab.wait_for_selector("#run:not([hidden])")


def test_a_report_can_ask_nothing_of_the_server(kept, tab, served):
    """It is a file that somebody may have changed, and its address holds the token."""
    ask = "fetch('../../ask/runs').then(() => 'answered', () => 'refused').then((it) => document.title = it)"
    (kept / "report.html").write_text(f"<title>?</title><h1>A report</h1><script>{ask}</script>")
    opened = tab.context.new_page()
    opened.goto(f"{served.address}runs/{kept.name}/report.html")
    opened.wait_for_function("() => document.title !== '?'")
    assert opened.title() == "refused"
    assert opened.evaluate("() => self.origin") == "null"
    opened.close()


@pytest.mark.parametrize(
    ("width", "scheme"), [(1280, "light"), pytest.param(360, "dark", marks=pytest.mark.long)]
)
def test_nothing_bars_anybody(kept, tab, width, scheme):
    """The rules of axe-core, with a run that is done."""
    tab.emulate_media(color_scheme=scheme)
    tab.set_viewport_size({"width": width, "height": 800})
    tab.click(f"#run-list a[href='#run={kept.name}']")
    tab.wait_for_selector("#watch:not([hidden])")
    assert_accessible(tab)
    assert tab.evaluate("document.documentElement.scrollWidth <= innerWidth")


@pytest.mark.parametrize("number", [pytest.param(signal.SIGINT, marks=pytest.mark.long), signal.SIGKILL])
def test_a_server_that_ends_leaves_no_orphan_and_keeps_its_runs(kept, tab, served, tmp_path, number):
    """Quietly where it may end in order."""
    tab.wait_for_selector("#run-list li[data-state=done]")
    done, name = tab.locator("#run-list li[data-state=done]").count(), f"a run until {number.name}"
    fill(tab, tmp_path, SMALL | {"seed": int(number)})
    roll(tab, name)
    becomes(tab, name, "running")
    children = psutil.Process(served.process.pid).children(recursive=True)
    assert len(children) >= 2
    code, told = served.end(number)
    assert left_of(children) == []
    if number == signal.SIGINT:
        assert (code, "Traceback" in told) == (0, False)
        assert told.strip().endswith("Ended; runs and surfaces are kept.")
    served.start()
    tab.goto(served.address)
    becomes(tab, name, "interrupted")
    assert tab.locator("#run-list li[data-state=done]").count() == done
    assert tab.is_visible(f"button[aria-label='Go on: {name}']")


def left_of(processes):
    """Those that still run after half a minute; what has ended and nobody has asked about does not run."""

    def runs(process):
        with suppress(psutil.NoSuchProcess):
            return process.status() != psutil.STATUS_ZOMBIE
        return False

    deadline = time.monotonic() + 30
    while (left := list(filter(runs, processes))) and time.monotonic() < deadline:
        time.sleep(0.05)
    return left
