"""What is wrong is told in a message, with exit code 2, and nothing is computed or written."""

import json
import os
import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from command_line import CASE, RAIL, SMALL, call, words_of, working_in

LINE = 'line = "line.npy"\nline_unit = "nm"\nline_spacing = "8 um"'
BALL = '[ball]\nload = "60 N"\n'
SAMPLES = '[contact]\nsamples = 2\napproaches = ["{}", "{}"]\n'
WHEEL = 'line = "wheel.npy"\nline_unit = "um"\n'


def on(surface):
    """The case with another surface."""
    return CASE.replace('rms = "0.5 um"', surface)


CASES = {
    "keys": CASE + 'hurts = 0.7\n[ball]\nradius = "-1 mm"\n',
    "strips": 'speed = "5 m/s"\n' + on('rms = "0.5 um"\nshortest = "0.2 mm"') + BALL
    + '[contact]\nwindow = "0.5 mm"\nspacing = "60 um"\nsample_length = "1 mm"\n',
    "hardness": CASE + BALL + '[contact]\nhardness = "1 MPa"\n',
    "step": CASE.replace('"0.01 s"', '"20 us"') + '[numerics]\ntime_step = "30 us"\n',
    "above": on('rms = "0.1 um"') + SAMPLES.format("-1 um", "-0.9 um"),
    "one": on('rms = "0.1 um"') + SAMPLES.format("-9 um", "3 um"),
    "several": on('file = "map.npy"\nheight_unit = "um"')
    + '[ball]\nload = "20 kN"\n[contact]\nspacing = "8 um"\nwindow = "0.5 mm"\n',
    "backslash-d": on(r'file = "C:\data\beam.x3p"'),
    "backslash-t": on(r'file = "C:\temp\beam.x3p"'),
    "single": on(r"file = 'C:\temp\beam.x3p'"),
    "unquoted": CASE.replace('"0.01 s"', "0.01 s"),
    "array": on('file = "maps.npz"'),
    "unit": on('file = "maps.npz"\narray = "polished"'),
    "line-array": on('line = "maps.npz"'),
    "line-unit": on('line = "maps.npz"\nline_array = "line"'),
    "line-spacing": on('line = "maps.npz"\nline_array = "line"\nline_unit = "um"'),
    "decimal": on('line = "comma.txt"\nline_unit = "um"'),
    "heading": on('line = "pairs.txt"\nline_unit = "um"'),
    "wheel": RAIL + WHEEL,
    "distance": f'{RAIL}{WHEEL}line_spacing = "1 mm"\n',
    "smooth": on("smooth = true") + BALL,
    "rigid": 'kind = "wheel-on-rail"\n[surface]\nsmooth = true\n[wheel]\nsection = "rigid"\n',
    "both": 'name = "6205"\nclearance = "1 um"\ncontact_angle = "15 deg"\naxial = "9 N"\n',
    "wrong": 'balls = 9\nball_diametre = "7.94 mm"\npitch_diameter = "39.04 mm"\nradial = "1 kN"\n',
    "study": 'case = "case.toml"\n[sweep]\nseed = [1, 2]\n',
}  # fmt: skip
OTHERS = {
    "metres.csv": "radius (mm), axial place (mm)\n" + "9e5, 0\n9e5, 1e5\n1e6, 1e5\n1e6, 0\n",
    "words.txt": "time\n1.0\nbroken\n",
    "commas.csv": "t (s),a (m/s^2)\n0,0000,-0,31\n0,0001,0,05\n",
    "uneven.txt": "1 2\n3\n",
    "none.txt": "nothing here\n",
    "comma.txt": "0,5\n1,5\n2,75\n",
    "pairs.txt": "".join(f"{x} {x % 3}\n" for x in range(20)),
    "odd.txt": "# unit: kg\n1\n2\n",
    "map.png": "heights in a picture",
    "bad.wav": "RIFF\x10\0\0\0WAVEfmt ",
    "taken": "in the way",
}
ENCODED = {
    "odd": CASE.encode("utf-16")[:-1],
    "latin": "# caf\u00e9\n".encode("cp1252"),
}


@pytest.fixture(scope="module", autouse=True)
def own_folder(tmp_path_factory):
    """One folder for all: nothing is left in it."""
    rng = np.random.default_rng(0)
    with working_in(tmp_path_factory.mktemp("refused")) as folder:
        for name, text in (CASES | {"case": CASE, "small": SMALL, "rail": RAIL}).items():
            Path(f"{name}.toml").write_text(text)
        for name, content in ENCODED.items():
            Path(f"{name}.toml").write_bytes(content)
        np.save("map.npy", rng.normal(size=(64, 64)))
        np.save("line.npy", rng.normal(size=900))
        np.save("wheel.npy", np.zeros((2890, 10)))
        hole = rng.normal(size=(40, 40))
        hole[3:8, 3:30] = np.nan
        np.save("hole.npy", hole)
        np.savez("maps.npz", polished=rng.normal(size=(3, 40, 32)), line=rng.normal(size=200))
        np.save("signal.npy", rng.normal(size=24_000))
        np.savez("two.npz", a=np.ones((9, 3)), b=np.ones((2, 2, 2)))
        for name, text in OTHERS.items():
            Path(name).write_text(text)
        for name, file in (("others", "run.nc"), ("page", "report.html")):
            Path(name).mkdir()
            Path(name, file).write_text("precious")
        yield folder


HINTS = "--height-unit um --pixel '2 um'"
VARY = "study rail.toml --vary"
HEARD = "bearing 6205 --speed '30 Hz' --rate '12 kHz' --signal"
WINDOWS = r"write Windows paths in single quotes, as in file = 'C:\data\beam.x3p', or with /"
REFUSED = [
    # use
    ("rn", "No such command 'rn'"),
    ("run case.toml --outptu x", "No such option"),
    ("run", "Missing argument"),
    ("compare", "Missing argument 'RUNS...'"),
    ("new ball-on-beam b.toml", "received 'b.toml' behind KIND; allowed: KIND and options. What it says goes "
     "into a file behind '>': > b.toml"),
    ("demo here now", "received 'here' 'now' behind the command; allowed: options. What it writes has its "
     "name behind -o: -o here"),
    ("run|check case.toml case.toml", "received 'case.toml' behind CASE; allowed: CASE and options. Give the "
     "command once for each file."),
    ("new ball-on-bam", 'Error: kind: received \'ball-on-bam\'; allowed: "ball-on-beam", "wheel-on-rail", '
     '"bodies", "ball-bearing", "roller-bearing", "study", "what-helps", "what-helps-in-bearings", '
     '"what-helps-in-roller-bearings", "optimisation", "optimisation-of-bearings". '
     'Did you mean "ball-on-beam"?'),
    ("new ball-on-beam --law aerial", "law: received 'aerial'; allowed: … Did you mean \"areal\"?"),
    # files and folders
    ("run|check|study absent.toml", "Error: absent.toml: received no such file; allowed: the path of a"),
    ("run .", "received a folder"),
    ("run|check case.toml -o case.toml", "folder of the results: received case.toml … case.toml is a file); "
     "allowed: a folder that can be written to. Choose another folder with -o."),
    ("run|check case.toml -o taken/out", "folder of the results: received taken/out … taken is a file)"),
    ("study study.toml -o taken/out", "folder of the results: received taken/out … taken is a file)"),
    ("run|check case.toml -o others", "others: received a run.nc that cannot be read … --overwrite"),
    ("run|check case.toml -o page", "page: received a report.html without its run.nc"),
    ("report|figures|cite|listen nothing", "nothing: received no such file; allowed: a result file"),
    ("report {run} -o taken", "folder of the report: received taken"),
    ("figures {run} -o taken", "folder of the figures: received taken … Choose another folder with -o."),
    ("compare {run} {run} -o taken", "folder of the comparison: received taken"),
    # encodings and TOML
    ("check odd.toml", "odd.toml: received a byte that is no UTF-16 … Save the file as UTF-8."),
    ("check latin.toml", "latin.toml: received a byte that is no UTF-8 in line 1 … Save the file as UTF-8."),
    ("check backslash-d.toml", WINDOWS),
    ("check backslash-t.toml", WINDOWS),  # TOML takes \t for a tab
    ("check single.toml", r"surface.file: received 'C:\temp\beam.x3p'; allowed: the path of an"),
    ("check unquoted.toml", "double quotes"),
    # cases
    ("run|check keys.toml", 'keys.toml: 2 errors … Did you mean "hurst"? … ball.radius'),
    ("check strips.toml", "contact.sample_length: received strips of"),
    ("check hardness.toml", "contact.hardness: received 0.001 GPa"),
    ("check step.toml", "duration: received 0.02 ms; allowed: at least one"),
    ("run|check above.toml", "contact.approaches: received up to -0.9 um, where the samples carry 0 N"),
    ("check one.toml", "contact.approaches: received up to 3 um, where the samples carry … and none at "
     "-9 um; allowed: at least two approaches in contact. Add some around"),
    ("run|check several.toml", "several.toml: 3 errors … - contact.window: received 504 um; allowed: at "
     'least … Give it, as in pixel = "1.5 um" in [surface]. … - $ASPERITY_THREADS: received \'many\''),
    ("check array.toml", 'Choose one, as in array = "polished" in [surface].'),
    ("check unit.toml", 'Give it, as in height_unit = "um" in [surface].'),
    ("check line-array.toml", 'Choose one, as in line_array = "polished" in [surface].'),
    ("check line-unit.toml", 'Give it, as in line_unit = "um" in [surface].'),
    ("check line-spacing.toml", 'Give it, as in line_spacing = "1.5 um" in [surface].'),
    ("check decimal.toml", "Write decimal points, or semicolons between columns."),
    ("check heading.toml", 'Write it into the heading, as "x (mm)".'),
    ("check wheel.toml", 'Give it, as in line_spacing = "1.5 um" in [wheel].'),
    ("check distance.toml", "wheel.line_distance: received no distance for 10 lines"),
    # measured files
    ("surface absent.x3p", "absent.x3p: received no such file; allowed: a file with heights."),
    (f"{HEARD} absent.npy", "absent.npy: received no such file; allowed: a file with signals."),
    ("surface maps.npz", "Choose one, as in --array polished."),
    ("surface maps.npz --array line", "Give it, as in --height-unit um."),
    ("surface maps.npz --array line --height-unit um", 'Give it, as in --pixel "1.5 um".'),
    (f"surface maps.npz --array polished --index 3 {HINTS}", "3"),
    ("surface comma.txt --height-unit um --pixel '1 um'", 'Give --decimal "," if the comma is the decimal '
     "mark; if it separates columns, give"),
    ("surface pairs.txt --height-unit um", "or give --pixel-unit mm."),
    ("surface odd.txt --pixel '1 um'", "leave the bracket out and give --height-unit um."),
    (f"surface map.npy --rotate 30 {HINTS}", "direction: received '30'; allowed: an angle, with its unit"),
    (f"surface line.npy --direction '30 deg' {HINTS}",
     "--direction: received a line; allowed: a height map. Leave it out."),
    ("surface|bearing|creep map.npy -o picture.doc", "a name that ends in .svg, .pdf, .png"),
    ("surface map.png -o map.png", "another name"),
    # creep, wheels and bearings
    ("creep smooth.toml --friction 0", "--friction: received 0"),
    ("creep smooth.toml --points 1", "--points: received 1; allowed: a whole number from 2 to 1000"),
    ("creep smooth.toml --states", "surface: received none, or as a line alone; allowed: a rough surface"),
    ("creep smooth.toml --states --friction 0.2", "--states: received --direction or --friction with it"),
    ("creep smooth.toml --states --direction spin", "--states: received --direction or --friction with it"),
    ("wheel straight", "allowed: curved-web, straight-web, bent-web, or the path of an outline"),
    ("wheel rigid.toml", "a wheel that is not drawn"),
    ("wheel metres.csv", "Is the unit of the coordinates right?"),
    ("wheel straight-web --highest 4", 'as "5 kHz"'),
    ("bearing 6299", "allowed: the path of a bearing file (TOML). Did you mean 6209"),
    ("bearing", "bearing: received none; allowed: a NAME or a FILE. 73 bearings have a name"),
    ("bearing 6205 --radial '100 N' --speed '6e5 1/min'", "1/min, with 25400 N of each ball outwards"),
    ("bearing 6205 --radial '1e-12 N' --speed '30 Hz'", "allowed: what the balls carry. Try another load"),
    ("bearing 6205 --radial 5", "radial: received '5'; allowed: a force at least 0, with its unit"),
    ("bearing both.toml", "received both clearance and contact_angle"),
    ("bearing wrong.toml", "ball_diametre: received an unknown key"),
    ("bearing 6205 --signal signal.npy --rate '12 kHz'", "speed: received nothing; allowed: the speed at"),
    ("bearing 6205 --speed '30 Hz' --signal signal.npy", 'Give it, as in --rate "12 kHz".'),
    (f"{HEARD} two.npz", "arrays of signals in two.npz: received a, b; allowed: exactly one."),
    (f"{HEARD} two.npz --array a", "received 3 columns; allowed: one of 1 to 3. Choose it with --column."),
    (f"{HEARD} two.npz --array b", "an array of shape (2, 2, 2)"),
    (f"{HEARD} words.txt", "words in line 3; allowed: numbers below the heading."),
    (f"{HEARD} commas.csv", "commas in numbers and between them; allowed: commas of one kind. Export"),
    (f"{HEARD} uneven.txt", "uneven.txt: received 1 cell in line 2; allowed: 2."),
    (f"{HEARD} none.txt", "none.txt: received no numbers"),
    (f"{HEARD} bad.wav", "a WAV file without its piece … The file is damaged or truncated"),
    (f"{HEARD} signal.npy --band '1 kHz'", "--band: received 1 kHz"),
    ("bearing 6205 --speed '0.1 Hz' --signal signal.npy --rate '12 kHz'", "Record longer."),
    # studies
    (f"{VARY} speed", "--vary: received 'speed'; allowed: a key of the case, =, and its values"),
    (f"{VARY} seed=1 --vary seed=1", "--vary: received seed more than once"),
    (f"{VARY} 'speed=20 m/s,'", "sweep.speed[2]: received ''"),
    (f"{VARY} 'wheel.load=5 kN,5000 N'", "wheel.load: received '5000 N' more than once"),
    (f"{VARY} seed=1 --workers 2 --scheduler x", "--workers: received a number beside --scheduler"),
    (f"{VARY} seed=1 --show 'transit exposure'", "--show: received 'transit_exposure'; allowed: names of "
     "what a study keeps: "),
    (f"{VARY} seed=1 -o rail.toml", "rail.toml is a file)"),
    (f"{VARY} seed=1 --noise '20 dB'", "--noise: received signals of no study; allowed: it goes with"),
    ("run|study small.toml --what-helps", "what helps: received a ball-on-beam case; allowed: a case over a"
     " track, which is heard, of a ball bearing, or of a kind that lists its own"),
    # runs
    ("listen {run} --what drums", "received 'drums'; allowed: acceleration"),
    ("figures {run} scene force_band -o new", 'Did you mean "force_bands"?'),
    ("compare {run} absent", "absent: received no such file; allowed: a result file that a run has written"),
]  # fmt: skip


DOCUMENTED = {"check", "study", "surface", "listen", "signals", "cite"}


def contents(folder):
    return {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize(("line", "message"), REFUSED)
def test_what_is_wrong_is_told_before_anything_is_computed(line, message, ran, own_folder, monkeypatch):
    """To people; and as a document, by most commands."""
    if "several" in line:
        monkeypatch.setenv("ASPERITY_THREADS", "many")
    before = contents(own_folder)
    commands, *words = shlex.split(line.replace("{run}", ran.path))
    for command in commands.split("|"):
        asked = [command, *words, *["--json"] * (command in DOCUMENTED)]
        refused = call(*asked, code=2)
        told = words_of(refused.stderr)
        assert re.search(".*?".join(map(re.escape, message.split(" … "))), told), told
        assert told.count("absent") <= 1
        assert "Traceback" not in told
        assert contents(own_folder) == before
        if "--json" in asked:
            document = json.loads(refused.stdout)
            assert (document["command"], document["exit_code"]) == (command, 2)
            assert words_of(document["error"]["message"]) in told


@pytest.mark.parametrize("command", ["run case.toml", "check case.toml", "study study.toml"])
@pytest.mark.skipif(not Path("/proc/self").exists(), reason="no folder in which nobody makes files")
def test_a_folder_that_not_even_the_superuser_writes_to_is_refused(command):
    assert "folder of the results" in call(*command.split(), "-o", "/proc/out", code=2).stderr
    assert not os.path.exists("cache")


def test_missing_heights_have_no_spectra(own_folder):
    """All else is said of them: the file of spectra is the last."""
    told = call("surface", "hole.npy", *shlex.split(HINTS), "--psd", "-o", "hole.png", code=2).stderr
    words = "--psd: received more than 5 % of points without a height; allowed: nearly complete heights"
    assert words in told
