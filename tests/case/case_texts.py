"""Texts of small cases of each kind, and the files that they name."""

import re

import pytest

from asperity.case.cases import parse_case
from asperity.errors import CaseError, InputError

SURFACES = {
    "ball-on-beam": 'rms = "0.5 um"',
    "wheel-on-rail": 'spectrum = "iso3095"',
    "bodies": 'rms = "50 nm"',
}
LEVELS = "wavelength (mm), level (dB re 1 um)\n100, 3\n80, 2\n63, 1\n50, 0\n"


def case_text(kind, text=""):
    """Text of a case from lines, or pieces between "|": keys of its top, then "[ball] load = …"."""
    lines = [line.strip() for line in text.replace("|", "\n").splitlines()]
    if "[surface]" not in text:
        lines += ["[surface] " + SURFACES[kind]]
    heading = re.compile(r"^(\[\w+\])\s*")
    return "\n".join([f'kind = "{kind}"', *(heading.sub(r"\1\n", line) for line in lines)])


def write_files(folder):
    """Write the files that the cases here name into a folder, most of them without sense."""
    (folder / "levels.csv").write_text(LEVELS)
    (folder / "ratios.csv").write_text("frequency (kHz), ratio\n0.1, 0.01\n1, 0.8\n")
    rates = "f (Hz); vertical (dB/m); lateral (dB/m)\n100; 4,5; 0,5\n125; 4; 0,5\n200; 5; 0,4\n"
    (folder / "rates.csv").write_text(rates)
    (folder / "mobility.csv").write_text("f (Hz), size (m/(N s))\n100, 1e-5\n200, 2e-5\n400, 1e-5\n")
    passage = "".join(f"{n}, {60 + 5 * min(n, 11 - n)}\n" for n in range(12))
    (folder / "passage.csv").write_text("time (s), level (dB(A))\n" + passage)
    (folder / "bands.csv").write_text("f (Hz), level (dB)\n100, 60\n125, 61\n160, 59\n")
    modes = "frequency (Hz), ratio, mass (kg)\n2000, 1e-4, 300\n3100, 1e-4, 250\n"
    (folder / "modes.csv").write_text(modes)
    rows = "".join(f"{100 * n}, {-1e-9 / n:.3g}, -1e-11\n" for n in range(1, 30))
    (folder / "receptance.csv").write_text("frequency (Hz), real (m/N), imaginary (m/N)\n" + rows)
    pad = "f (Hz), real (MN/m), imaginary (MN/m)\n10, 90, 9\n300, 120, 18\n2000, 160, 40\n"
    (folder / "pad.csv").write_text(pad)
    for name in ("line.csv", "map.npy", "tread.csv", "rail.csv", "beam.x3p", "wheels.csv", "recipe.toml"):
        (folder / name).write_bytes(b"heights")
    return folder / "case.toml"


def refusal_of_table(read, keys, key, file, text):
    """What is said of a wrong table, by its reader; and of a case whose key names it, alike."""
    file.write_text(text + "\n")
    with pytest.raises(InputError) as caught:
        read(file)
    with pytest.raises(CaseError) as refused:
        parse_case(case_text("wheel-on-rail", keys), file.parent / "case.toml")
    (error,) = refused.value.errors
    assert error.startswith(f"{key}: received ")
    assert f"in {file.name}" in error
    return str(caught.value), error
