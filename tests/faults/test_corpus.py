"""What once failed, replayed: each ends in time, with its exit code and one message.

Each took minutes or all memory, ended with a traceback, or was read wrongly. What can be seen without the
command line is tested beside its function: `tests/test_hostile_text.py`,
`tests/surfaces/test_malformed_files.py`, `tests/test_terminal.py`, `tests/rolling/test_stability.py`,
`tests/reporting/test_schema.py`.
"""

import os
import re
import signal
import sys
from pathlib import Path
from threading import Timer

import numpy as np
import pytest
from program import RUN, here, in_time, left
from surface_files import npy

import asperity
from asperity.errors import InputError
from asperity.files import atomic_write
from asperity.interrupts import interruptible

SECONDS = 60
"""That no failure takes."""
BALL = 'kind = "ball-on-beam"\nlaws = ["hertz"]\nduration = "5 ms"\n'
ROUGH = '[surface]\nrms = "0.3 um"\n'
MAP = '[surface]\nfile = "{}"\nheight_unit = "um"\npixel = "8 um"\n'
ONE = "[contact]\nsamples = 1\n"
FREE = '[ball]\nload = "20 N"\n[beam]\nsupport = "free"\nsuspension_frequency = "0.1 Hz"\n'
CIRCLES = Path(__file__).with_name("circles.nc").read_bytes()  # in which HDF5 turns in circles
ENDS = Path(__file__).with_name("ends.nc").read_bytes()  # which ends the process that reads its variables


def case(text, says, **files):
    """A case that is checked: the words, the exit code that is right, what has to be said, and the files."""
    return ("check", "case.toml"), 2, says, {"case.toml": text} | files


LOADS = 'case = "case.toml"\n[sweep]\nseed = "1..9999"\nball.load = ["-1 N"]\n'
CORPUS = {
    "9999 seeds": (
        ("study", "study.toml"), 2, r"1 error\n.*load\[1\]: received '-1 N'",
        {"case.toml": BALL + ROUGH, "study.toml": LOADS},
    ),
    "a list for a word": case("kind = []\n", r"kind: received \[\]"),
    "a beam 1 um wide": case(f'{BALL}{ROUGH}[beam]\nwidth = "1 um"\n', "width: .*allowed: at least 187 um"),
    "a ball of 1e-9 kg": case(
        f'{BALL}settling = "0 s"\n{ROUGH}[ball]\nmass = "1e-9 kg"\n', r"surface\.rms: .* 100 approaches"
    ),
    "1 mm/s": case(f'{BALL}speed = "1 mm/s"\n{ROUGH}', r"contact\.spacing: received 0\.1 um at 0.001 m/s"),
    "a free beam on 0.1 Hz": (
        ("run", "case.toml", "--no-report"), 3,
        r"displaced by up to 51.6 m under the contact(.*\n)*Error: hertz: nothing touches in all of the rec",
        {"case.toml": f"{BALL}{ROUGH}{ONE}{FREE}"},
    ),
    "a constant map": case(
        f'{BALL.replace("5 ms", "0.2 s")}{MAP.format("map.npy")}',
        "a plane without roughness, map.npy",
        **{"map.npy": npy(np.ones((200, 200)))},
    ),
    "a folder whose name is markup": (
        ("check", "a [/b]/case.toml"), 2, r"a \[/b\]/case\.toml: 1 error", {"a [/b]/case.toml": BALL}
    ),
    "a library that ends": (
        ("surface", "a.nc", "--height-unit", "um", "--pixel", "1 um"), 2,
        "while it was opened; allowed: an intact netCDF file", {"a.nc": ENDS},
    ),
}  # fmt: skip


@pytest.fixture
def replay(tmp_path):
    """Let the program run in a folder with these files; returns its exit code and all it said."""

    def replay(words, files):
        for file, contents in files.items():
            (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / file).write_bytes(contents if isinstance(contents, bytes) else contents.encode())
        with in_time(SECONDS):
            return here(tmp_path, *words)

    return replay


@pytest.mark.usefixtures("opened_apart")
@pytest.mark.parametrize("name", CORPUS)
def test_what_once_failed(name, tmp_path, replay):
    words, code, says, files = CORPUS[name]
    found, told = replay(words, files)
    assert found == code
    assert re.search(says, told), told
    assert len(told) < 2000
    assert "\x1b" not in told
    assert left(tmp_path) == []


@pytest.fixture
def circles(tmp_path, opened_apart):
    """A file in which HDF5 turns in circles, with a seal that fits; opened as the program does."""
    return atomic_write(tmp_path / "run.nc", lambda file: file.write(CIRCLES), sealed=True)


def test_a_library_that_turns_in_circles(circles, monkeypatch):
    """The process ends by itself, or beside other work by the patience of this one: both say the same."""
    monkeypatch.setattr("asperity.sandbox.SECONDS", 0.9)
    with pytest.raises(InputError, match=r"a file that takes more than 1 s to open"):
        asperity.open_result(circles)


@pytest.mark.skipif(sys.platform == "win32", reason="there are no such signals")
def test_a_right_seal_around_a_hostile_file_leaves_the_program_free_to_end(circles):
    with interruptible():
        Timer(0.7, os.kill, (os.getpid(), signal.SIGTERM)).start()
        with pytest.raises(KeyboardInterrupt):
            asperity.open_result(circles)


WHEEL = (
    f'kind = "wheel-on-rail"\nlaws = ["hertz"]\nduration = "50 ms"\n[surface]\nspectrum = "iso3095"\n{ONE}'
)
DAMPED = (
    f'{WHEEL}damping = "{{}} N s/m"\n[numerics]\nhighest_frequency = "2 kHz"\n[wheel]\nsection = "rigid"\n'
)
LIGHT = f'{BALL.replace("5 ms", "20 ms")}{ROUGH}{ONE}[ball]\nload = "5 N"\nmass = "1e-5 kg"\n'
MODES = "frequency (Hz), damping ratio, modal mass (kg)\n" + "".join(
    f"{300 + 20 * i}, 0.001, 100\n" for i in range(200)
)


@pytest.mark.parametrize(
    ("text", "load", "largest"),
    [
        (DAMPED.format("1e6"), 65e3, 2.0),
        pytest.param(DAMPED.format("1e9"), 65e3, 2.0, marks=pytest.mark.long),
        (LIGHT, 5.0, 5.0),
        pytest.param(f'{WHEEL}[wheel]\nmodes = "modes.csv"\n', 65e3, 3.0, marks=pytest.mark.long),
    ],
    ids=["damping of 1e6 N s/m", "damping of 1e9 N s/m", "a ball of 1e-5 kg", "200 modes of 100 kg"],
)
def test_absurd_bodies_press_no_more_than_their_load(text, load, largest, replay, tmp_path):
    """Legal cases whose forces once grew beyond all measure, and how many times the load none may reach."""
    found, told = replay(RUN, {"case.toml": text, "modes.csv": MODES})
    assert found == 0, told
    force = asperity.open_result(tmp_path / "out")["rolling/contact_force"].values
    assert np.isfinite(force).all()
    assert force.max() < largest * load
    assert force.mean() == pytest.approx(load, rel=0.02)
