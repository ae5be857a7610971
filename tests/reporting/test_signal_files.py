"""Signals of a run in universal files and WAV: what other programs read, to their digits, in their units."""

import csv
import json
import struct

import numpy as np
import pytest
import xarray

import asperity
from asperity.studies.recorded import read_record
from asperity.universal_files import Channel, universal_text
from asperity.wave_files import chunks_of, told_scale, wave_bytes
from refusals import refusals

pyuff = pytest.importorskip("pyuff")

RATE = 51_200.0
TIME = np.arange(2000) / RATE
FORCE = 100.0 + np.stack([np.sin(2 * np.pi * 1000 * TIME), 1e-3 * np.cos(2 * np.pi * 3000 * TIME)])
FREQUENCY = 12.5 * np.arange(50)


def result(**more):
    """A made-up run: forces of two contacts by two laws, an acceleration, a tacho and a spectrum."""
    force = np.stack([FORCE, 2.0 * FORCE])
    rolling = {
        "contact_force": (("law", "contact", "time"), force, {"units": "N", "long_name": "contact force"}),
        "acceleration": (("law", "sensor", "time"), force[:, :1] - 100.0, {"units": "m/s2"}),
        "displacement": (("law", "contact", "time"), 1e-6 * force, {"units": "m"}),
        "tacho_speed": ("time", 30.0 + TIME, {"units": "Hz", "long_name": "turns per second"}),
        "gaps": ("time", np.where(TIME > 0.01, np.nan, 1.0), {"units": "N"}),
    } | more
    at = {"law": ["hertz", "linear"], "time": TIME, "sensor": ("sensor", [0.5], {"units": "m"})}
    psd = {"force_psd": (("law", "frequency"), np.outer([1.0, 2.0], FREQUENCY), {"units": "N2/Hz"})}
    spectra = xarray.Dataset(psd, coords={"law": at["law"], "frequency": FREQUENCY})
    return xarray.DataTree.from_dict({"/rolling": xarray.Dataset(rolling, coords=at), "/spectra": spectra})


def opened(path):
    """Datasets of a universal file, as pyuff reads them."""
    file = pyuff.UFF(str(path))
    return [file.read_sets(n) for n in range(len(file.get_set_types()))]


def test_another_program_reads_signals_to_their_digits_with_units_and_places(tmp_path):
    (file,) = asperity.write_signals(result(), tmp_path)
    units, *sets = opened(file)
    assert [units[name] for name in ("type", "length", "force")] == [164, 1.0, 1.0]
    words = [each["id1"].strip() for each in sets]
    assert words == [
        *("contact_force by hertz",) * 2, *("contact_force by linear",) * 2,
        "acceleration by hertz", "acceleration by linear", "tacho_speed",
        "force_psd by hertz", "force_psd by linear",
    ]  # fmt: skip
    first = sets[0]
    np.testing.assert_allclose(first["data"], FORCE[0], rtol=5e-13)
    np.testing.assert_allclose(sets[3]["data"], 2.0 * FORCE[1], rtol=5e-13)
    np.testing.assert_allclose(first["x"], TIME, rtol=5e-7)
    told = ("func_type", "rsp_node", "ord_data_type", "abscissa_spec_data_type", "ordinate_spec_data_type")
    assert [first[name] for name in told] == [1, 1, 4, 17, 13]
    assert [first[f"ordinate_{of}_unit_exp"] for of in ("len", "force", "temp")] == [0, 1, 0]
    assert [first["ordinate_axis_units_lab"].strip(), first["abscissa_axis_units_lab"].strip()] == ["N", "s"]
    assert [sets[n]["rsp_node"] for n in range(4)] == [1, 2, 1, 2]
    assert [sets[4][name] for name in ("ordinate_spec_data_type", "ordinate_len_unit_exp")] == [12, 1]
    assert sets[4]["id4"].strip() == "sensor 0.5 m"
    spectrum = sets[8]
    assert [spectrum[name] for name in told[:1] + told[3:]] == [9, 18, 13]
    assert spectrum["ordinate_axis_units_lab"].strip() == "(N)^2/Hz"
    np.testing.assert_allclose(spectrum["data"], 2.0 * FREQUENCY)
    np.testing.assert_allclose(spectrum["x"], FREQUENCY)


@pytest.mark.parametrize(("unit", "length", "force"), [
    ("m", 1, 0), ("m/s", 1, 0), ("m/s2", 1, 0), ("N", 0, 1), ("Pa", -2, 1), ("Hz", 0, 0), ("dB", 0, 0)
])  # fmt: skip
def test_exponents_of_a_unit_are_those_of_its_length_and_force(unit, length, force, tmp_path):
    """By which programs turn values into units of their own: a pressure is N/m^2."""
    file = tmp_path / "signals.uff"
    file.write_text(universal_text([Channel("signal", np.arange(8.0), 0.1, unit)]))
    units, signal = opened(file)
    assert units["temp_offset"] == 273.15
    assert signal["ordinate_len_unit_exp"] == length
    assert signal["ordinate_force_unit_exp"] == force


@pytest.mark.usefixtures("opened_apart")
def test_the_package_reads_its_own_universal_file_by_names(tmp_path):
    (file,) = asperity.write_signals(result(), tmp_path)
    read = read_record(file, array="contact_force by linear 2")
    assert read.rate == pytest.approx(RATE, rel=1e-6)
    np.testing.assert_allclose(read.values, 2.0 * FORCE[1], rtol=5e-13)
    with pytest.raises(
        asperity.errors.InputError, match="received contact_force by hertz 1, contact_force by hertz 2"
    ):
        read_record(file)
    with pytest.raises(asperity.errors.InputError, match="received 'force_psd by hertz'; allowed: one of: "):
        read_record(file, array="force_psd by hertz")


def test_binary_universal_files_and_uneven_times_are_read(tmp_path):
    """By the definition: 58b, little-endian, IEEE, eleven lines of words, then bytes."""
    lines = universal_text([Channel("B1", FORCE[0], 1 / RATE, "N")]).splitlines()
    words = lines[lines.index("    58") + 1 :][:11]
    data = FORCE[0].astype("<f8").tobytes()
    kind = f"    58b{1:6d}{2:6d}{11:12d}{len(data):12d}{0:6d}{0:6d}{0:12d}{0:12d}"
    head = "\n".join(["    -1", kind, *words, ""]).encode()
    (tmp_path / "binary.uff").write_bytes(head + data + b"\n    -1\n")
    read = read_record(tmp_path / "binary.uff")
    assert read.rate == pytest.approx(RATE, rel=1e-6)
    np.testing.assert_array_equal(read.values, FORCE[0])
    words[6] = words[6].replace(f"{2000:10d}{1:10d}", f"{2000:10d}{0:10d}")
    pairs = [f"{at:13.5E}{value:20.12E}" for at, value in zip(TIME, FORCE[0], strict=True)]
    (tmp_path / "pairs.uff").write_text("\n".join(["    -1", "    58", *words, *pairs, "    -1", ""]))
    read = read_record(tmp_path / "pairs.uff")
    assert read.rate == pytest.approx(RATE, rel=1e-4)
    np.testing.assert_allclose(read.values, FORCE[0], rtol=5e-13)


def test_wav_files_hold_every_signal_at_its_rate_and_say_what_full_scale_is(tmp_path):
    files = asperity.write_signals(result(), tmp_path, format="wav")
    with open(tmp_path / "signals.csv", newline="") as opened:
        rows = list(csv.DictReader(opened))
    assert [row["file"] for row in rows] == [file.name for file in files]
    assert files[0].name == "contact_force-hertz-contact_1.wav"
    assert len(files) == len(set(files)) == 7
    for file, row, signal in zip(files[:2], rows, FORCE, strict=False):
        read = read_record(file)
        assert read.rate == RATE
        assert float(row["largest"]) == pytest.approx(abs(signal).max(), rel=1e-12)
        np.testing.assert_allclose(read.values, signal, rtol=0.0, atol=0.51 * abs(signal).max() / 2**23)
        text = next(
            file.read_bytes()[at : at + length] for name, at, length in chunks_of(file) if name == b"LIST"
        )
        told = json.loads(text.partition(b"ICMT")[2][4:].rstrip(b"\0"))
        assert told["full_scale"] == pytest.approx(abs(signal).max(), rel=1e-12)
        assert [told[name] for name in ("at", "unit", "what")] == [2**23 - 1, "N", "contact_force by hertz"]


@pytest.mark.parametrize("bits", [16, 24])
@pytest.mark.parametrize("count", [1, 2])
def test_other_programs_read_what_is_between_the_pieces_of_a_wav_file(bits, count, tmp_path):
    """One channel of 24 bits has an odd number of bytes here."""
    from scipy.io import wavfile

    channels = np.stack([np.linspace(-3.0, 2.0, 101), np.zeros(101)][:count], axis=1)
    (file := tmp_path / "a.wav").write_bytes(content := wave_bytes(channels, 8000.0, 3.0, "Pa", bits=bits))
    rate, samples = wavfile.read(file)
    samples = samples.reshape(101, count)
    full = 2 ** (bits - 1) - 1
    numbers = samples / 2 ** (8 * samples.itemsize - bits) * 3.0 / full
    assert rate == 8000
    np.testing.assert_allclose(numbers, channels, atol=1.6 / full)
    assert struct.unpack("<I", content[4:8])[0] == len(content) - 8
    assert told_scale(file) == pytest.approx(3.0 / full)
    np.testing.assert_allclose(read_record(file, column=1).values, channels[:, 0], atol=1.6 / full)


@pytest.mark.parametrize(
    "comment", [b"made by hand", b'{"full_scale": -1, "at": 1}', b'{"full_scale": 1, "at": 0}', b"[]"]
)
def test_a_comment_that_is_no_scale_is_none(comment, tmp_path):
    content = wave_bytes([1.0, -0.5], 8000.0, 2.0, "N")
    own = content[content.index(b"ICMT") + 8 :]
    (file := tmp_path / "a.wav").write_bytes(content.replace(own, comment.ljust(len(own), b"\0")[: len(own)]))
    assert told_scale(file) is None
    assert read_record(file).values.tolist() == pytest.approx([0.5, -0.25], rel=1e-4)


def test_words_of_a_universal_file_are_plain_and_short():
    text = universal_text([Channel("µ" * 100, np.arange(5.0), 1e-3, "N", about=("\n", "", "x"))])
    lines = text.splitlines()
    assert all(len(line) <= 80 and line.isascii() for line in lines)
    assert lines[8:13] == ["?" * 80, "NONE", "NONE", "x", "NONE"]


def test_real_runs_are_written_with_their_tacho(real_runs, tmp_path):
    (file,) = asperity.write_signals(real_runs["wheel-on-rail"], tmp_path)
    words = {each["id1"].strip().partition(" by ")[0] for each in opened(file)[1:]}
    assert {"contact_force", "momentary_speed", "point_velocity", "pass_by_pressure", "force_psd"} <= words
    (one,) = asperity.write_signals(
        real_runs["wheel-on-rail"], tmp_path, what="rail_displacement", format="wav"
    )[:1]
    assert one.name.startswith("rail_displacement")


test_what_cannot_be_written_is_refused = refusals(
    (lambda: asperity.write_signals(None, "a"), "what asperity.run or asperity.open_result returned"),
    (lambda: asperity.write_signals(result(), "a", format="mp3"), "format of the signals: received 'mp3'"),
    (
        lambda: asperity.write_signals(result(), "a", what="sound"),
        "received 'sound'; allowed: contact_force, ",
    ),
    (
        lambda: asperity.write_signals(result(), "a", what="force_psd", format="wav"),
        'received spectra alone; allowed: signals over time in WAV; format "uff" has both',
    ),
    (
        lambda: asperity.write_signals(xarray.DataTree(), "a"),
        "received none of two samples or more; allowed: a run that was recorded in time",
    ),
)
