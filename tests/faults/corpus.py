"""What once failed: files, words after ``asperity``, the exit code that is right, and what has to be said.

Each took minutes or all memory, ended with a traceback, or was read wrongly. What can be seen without the
program is tested beside its function: `tests/test_hostile_text.py`, `tests/surfaces/test_malformed_files.py`,
`tests/test_terminal.py`, `tests/rolling/test_stability.py`, `tests/scenarios/test_missing.py`.
"""

import base64
import io
import zipfile
import zlib
from typing import NamedTuple

import numpy as np

MANY = 64_000
BALL = 'kind = "ball-on-beam"\nlaws = ["hertz"]\nduration = "5 ms"\n'
RAIL = 'kind = "wheel-on-rail"\nlaws = ["hertz"]\nduration = "50 ms"\n'
ROUGH = '[surface]\nrms = "0.3 um"\n'
MAP = '[surface]\nfile = "map.npy"\nheight_unit = "um"\npixel = "8 um"\n'
ONE = "[contact]\nsamples = 1\n"
HINTS = ("--height-unit", "um", "--pixel", "1 um")


class Absurd(NamedTuple):
    """A case that is legal, and whose forces once grew beyond all measure.

    Attributes
    ----------
    text : str
        The case.
    load : float
        Static load, N.
    largest : float
        How many times the load no contact force may reach.
    files : dict of str to str
        What lies beside it.
    """

    text: str
    load: float
    largest: float
    files: dict[str, str]


class Failure(NamedTuple):
    """A command that once failed.

    Attributes
    ----------
    words : tuple of str
        What stands after ``asperity``.
    code : int
        Exit code that is right.
    says : str
        A regular expression that what it prints holds.
    files : dict of str to str or bytes
        What lies in its folder.
    """

    words: tuple[str, ...]
    code: int
    says: str
    files: dict[str, str | bytes]


def case(text, says, code=2, files=None):
    """A case that is checked."""
    return Failure(("check", "case.toml"), code, says, {"case.toml": text, **(files or {})})


def study(sweep, says, text=BALL + ROUGH):
    """A study that cannot begin."""
    file = f'case = "case.toml"\n[sweep]\n{sweep}'
    return Failure(("study", "study.toml"), 2, says, {"case.toml": text, "study.toml": file})


def surface(name, contents, says, *hints):
    """A file that is looked at."""
    return Failure(("surface", name, *hints), 2, says, {name: contents})


def modes(table, says):
    """A wheel with a table of modes; a name stands for a file elsewhere."""
    file = table if table.startswith("/") else "modes.csv"
    text = f'kind = "wheel-on-rail"\n[surface]\nsmooth = true\n[wheel]\nmodes = "{file}"\n'
    return case(text, says, files={} if file == table else {file: table})


def npy(values):
    """Contents of a ``.npy`` file."""
    stream = io.BytesIO()
    np.save(stream, values)
    return stream.getvalue()


def npz(members):
    """Contents of a ``.npz`` file."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as opened:
        for name, contents in members.items():
            opened.writestr(f"{name}.npy", contents)
    return stream.getvalue()


def unpacked(text):
    """A file that is kept here as letters."""
    return zlib.decompress(base64.b85decode(text))


QUADRATIC = {  # regular expressions that took time with the square of a length
    "digits": case(f'{BALL}speed = "{"1" * 16_000}_"\n{ROUGH}', r"speed: received '1{50,}…"),
    "digits in a header": surface("a.txt", f"# pixel = {'1' * MANY}_ um\n1 2\n3 4\n", "without a unit"),
    "spaces before a bracket": surface("a.txt", f"# unit{' ' * MANY}(\n1 2\n3 4\n", "without a unit"),
    "spaces after a name": surface("a.txt", f"# dx{' ' * MANY}x\n1 2\n3 4\n", "without a unit"),
    "brackets in a header": surface("a.txt", f"# {'(' * MANY}\n1 2\n3 4\n", "without a unit"),
    "brackets in a heading": modes(
        f"{'(' * MANY}, b (dB{' ' * MANY}x, c\n1, 2, 3\n", "a heading with the units in"
    ),
}

WITHOUT_END = {
    "a key of 20 000 parts": case(f"{BALL}{'.'.join('a' * 20_000)} = 1\n", "a key of more than 20 parts"),
    "5000 brackets": case(f"laws = {'[' * 5000}{']' * 5000}\n", r"case\.toml: received"),
    "200 000 words": case("laws = [" + '"x", ' * 200_000 + "]\n", "received 2000.. keys and values; allowed"),
    "500 errors": case(
        BALL + "".join(f"a{i} = 1\n" for i in range(500)) + ROUGH,
        r"500 errors\n(  - .*\n){10}  - and 490 more",
    ),
    "9999 seeds": study(
        f'seed = {list(range(9999))}\n"ball.load" = ["-1 N"]\n',
        r"1 error\n.*ball\.load\[1\]: received '-1 N'",
    ),
    "a wave of 10 m": case(
        f'{BALL}{ROUGH}longest = "10 m"\n', "longest: received 10 m .*at most 134217728 points"
    ),
    "an anisotropy of 1e-9": case(f"{BALL}{ROUGH}anisotropy = 1e-9\n", "anisotropy: .*allowed: 0.01 to 100"),
    "an accuracy of 1e-300": case(
        f"{BALL}{ROUGH}[numerics]\nforce_accuracy = 1e-300\n", r"numerics\.force_accuracy: received 1e-300"
    ),
}

NUMBERS = {
    "5e-324": case(f'{BALL}speed = "5e-324 m/s"\n{ROUGH}', "speed: received '5e-324 m/s'.*1e-30 and 1e"),
    "1e200": case(f'{BALL}[surface]\nrms = "1e200 m"\n', r"surface\.rms: received '1e200 m'"),
    "400 digits": case(f"{BALL}seed = {'1' * 400}\n{ROUGH}", "seed: received 1{50,}…"),
    "400 digits of a quantity": case(f'{BALL}speed = "{"1" * 400} m/s"\n{ROUGH}', "speed: received '1{50,}…"),
    "1_0": case(f'{BALL}speed = "1_0 m/s"\n{ROUGH}', "speed: received '1_0 m/s'"),
    "1_0 in a table": modes("1, 0.1, 3\n1_0, 0.1, 3\n", "received '1_0, 0.1, 3' in line 2"),
    "1_0 in a file": surface("a.csv", "1;2\n1_0;4\n", "'1_0;4' in line 2", *HINTS),
    "1_0 above numbers": surface("a.csv", "1_0;2\n3;4\n5;6\n", "'1_0;2' in line 1", *HINTS),
    "a list for a word": case("kind = []\n", r"kind: received \[\]"),
    "lists for words": study("laws = [[[1]]]\n", r"sweep\.laws\[1\]: received \[1\]"),
    "a key twice": study('ball.load = ["1 N"]\n"ball.load" = ["2 N"]\n', "the key more than once"),
}

BODIES = {  # legal, and absurd
    "a beam 1 um wide": case(
        f'{BALL}{ROUGH}[beam]\nwidth = "1 um"\n', r"beam\.width: received 1 um; allowed: at least 187 um"
    ),
    "a beam 1 um high": case(
        f'{BALL}{ROUGH}[beam]\nheight = "1 um"\n', r"beam\.height: received 1 um; allowed: at least 187 um"
    ),
    "a ball of 1e-9 kg": case(f'{BALL}{ROUGH}[ball]\nmass = "1e-9 kg"\n', "heights with an rms slope of 1"),
    "1 mm/s": case(f'{BALL}speed = "1 mm/s"\n{ROUGH}', r"contact\.spacing: received 0\.1 um at 0.001 m/s"),
    "approaches that never touch": case(
        f'{BALL}{ROUGH}{ONE}approaches = ["-78 um", "-77 um"]\n',
        r"contact\.approaches: received up to -77 um, where the samples carry 0 N",
    ),
    "a free beam on 0.1 Hz": Failure(
        ("run", "case.toml", "--no-report"),
        3,
        r"displaced by up to 51.6 m under the contact(.*\n)*Error: hertz: nothing touches in all of the rec",
        {
            "case.toml": f'{BALL}{ROUGH}{ONE}[ball]\nload = "20 N"\n[beam]\nsupport = "free"\n'
            'suspension_frequency = "0.1 Hz"\n'
        },
    ),
    "a constant map": case(
        f'{BALL}duration = "0.2 s"\n{MAP}'.replace('duration = "5 ms"\n', "", 1),
        "a plane without roughness, map.npy",
        files={"map.npy": npy(np.ones((200, 200)))},
    ),
}

PLACES = {  # what cannot be read, or written to
    "a file of the kernel": modes("/proc/kmsg", r"wheel\.modes: .*kmsg"),
    "a device": Failure(("surface", "/dev/zero", *HINTS), 2, "/dev/zero: received a pipe or a device", {}),
    "a name of 300 letters": Failure(("check", "a" * 300), 2, "File name too long", {}),
    "a folder of 300 letters": Failure(
        ("run", "case.toml", "-o", "a" * 300), 2, "File name too long", {"case.toml": BALL + ROUGH}
    ),
    "a name that is no UTF-8": Failure(
        ("check", "\udcff.toml"), 2, r"\\xff\.toml: received no such file", {}
    ),
}

ESCAPE = "\x1b]0;owned\x07"
NAMES = {  # that are markup, or control a terminal
    "a map": Failure(
        ("check", "case.toml"),
        0,
        r"map \[um\] v2\.npy",
        {
            "case.toml": BALL + MAP.replace("map.npy", "map [um] v2.npy") + ONE,
            "map [um] v2.npy": npy(np.random.default_rng(1).normal(size=(120, 120))),
        },
    ),
    "a folder": Failure(
        ("check", "a [/b]/case.toml"), 2, r"a \[/b\]/case\.toml: 1 error", {"a [/b]/case.toml": BALL}
    ),
    "a file": case(
        f'{BALL}[surface]\nfile = "\\u001b[31m.npy"\n', r"surface\.file: received '\\x1b\[31m\.npy'"
    ),
    "a key": case(f'{BALL}{ROUGH}"\\u001b[31mred" = 1\n', r"surface\.\\x1b\[31mred: received an unknown key"),
    "an array": surface(
        "a.npz",
        npz({ESCAPE: npy(np.eye(4)), "b": npy(np.eye(4))}),
        r"received \\x1b\]0;owned\\x07, b; allowed",
        *HINTS,
    ),
}

CIRCLES = unpacked(  # a netCDF file in which HDF5 turns in circles
    "c-rlmPe>F|9LL|xtTO26Zn@?92b@GADArZi@UplvJEpkq%8nEiw5{!k13D|aqh=tT>(n8lo9Bo+MyE*V(jlm$7wJ^j4s{Fcy"
    "?O8L&Ma$+L0SAhsBhk%-~0V}&sq6;e=0TE*3#XA2(pX<D1^N1GmJrhpU>Yyza~4C%8AM+vES`UQr))ow1`L`^UY!MQwZ>Fgg"
    "Y|=ed03$pV@pa`e#Hwb2rHB&-5blBnb!l4Y^t0=%(vU?sfnjk?o<5FK()BR|O&BdKYMfJmYE`CK;YO*N13uD(aL`=RN$?B$F"
    "9Y6kS6a(M~6|+C%<K0taTI#9i;G9Vtjg`Hbn@E-uDX){0dmyUM8Qm#(X!#7JL2&Dc&xT6)4T@Ms6I@~liv&*~XtI-AKG+C*A"
    "M3cdm4(3)JU%*3pYm{rnaHNRw4RQy#?ZPU?GlWNggG3|;~vekt(N3}~%ZEC$xwh9Z&W>n>j;2k!4o_%XvVSY&h$Exsl<j+)C"
    "IMEd*DLsAs@inb5F6{+3X3>9#19f+~uHx!Ajt{wU#amH)U#eDIq8qiUq{og8??PWSi_5rzOJ;dwn2yWtotH$Zr>W+SxRQ@_J"
    "oH!%_KRb)5b5Yvm;bQcDmLQ5+nf3MoUW78s&`O4<XvC{{r&oC$p`=d00000_<#92&K{ENuRqp?SQ}<-gtfh_Rax85+5y&{Pr"
    "liE_Z{jA00000CyT5$HA6HzqRj<S2t_=KUV7S?M~J9UM2{jG6;Xq@lF60ps)CKbjlSBmw@=o*eDdQx@g|=pBa%>6D4D(Til|"
    "Q{3I|7#(<k+up3!s`#aWR?Q7kxxis>Ah7mv0oEVA*#^ep1Tr--s_y~-#d81UOYQZ9aOlwIhb&W`tAe0X@>y(x246AmK<XTjB"
    "EtyC%(ExX{D73xK9?4|z3a1TVI7LWH|fF!MIGmc0`YqsT(2)eMp5c2BOvd>cV+)Sc(j_q!2x!GN#tJ+=dI-k+z%B5Aa>{xDI"
    "9oT%(v&*_!CY4VNUs@Wq-H;PQ(XlA*78geo!_inYhG$kc6C=@~%hA|wVr2(jHvj;fAg*ZHw7@?aJa0GtNiriqjQ{`u000000"
    "04fQeJBC&climwL373"
)
ENDS = unpacked(  # and one that ends the process that opens it
    "c-rlmO-vI(6vt<G3)w)SRjQPagq09uqA3N6;nGmDU4#HF=@Lyeu@<|8P3V@i3y2BvtS1k~c;l)udNiJlBwjq2=#dNYq*o7mG"
    "r^ginRa(mgm6$a?-yWpX7<hdnCX`M_x@CRvaO}N1rcN!1yC5d*=Oj3-aendg?>+VDxDL9pT&NsCrQ3#{j`WkAoI-;@>dA(Wr"
    "RC30=?oh0-xD@A$n&-K65w3?9cQfawQ1|`VBi--{_|I8{F*xIwIRc9bcVP+pY>i)bTFR2zkb}HbOEyb*>N5;1tv;qt1Kys!1"
    "j@q9{6sG@_kOYPE;FnFJ2ZB$#l#qjnTTGRkKR`*v|Dkv2<ak*q4CnqPWfonV~w1=Nh~WTehc=sF(lAXctB)6;WWMxV}R^13="
    "PtDzu10c6vf9IMR4oQ9ZH%4M~%Y*rQgQ&23!R@0M8(JUEO)ht`e;+m~kWxGDLUZ|Lb#T6r_a7OS78$HjzH?A;0B!Od9csu%M"
    "DlDAn3X_zcJ^u8DRv4G|f)lgoJ;MRtS@u<28OQM<C$2;*O6*Iuic55%R)zG~w&7Liqh@IZS8&;=j11Fp**Wu)DD^be-4R#vk"
    "+z3!tIj?+77LM%ZgqJ#+o@tB9=yAmU&v`1*{%B0<hh0R4|^8qA#dMbEg1m-000000RJ!F#@R)R{rAV(Fl!^Mjk30vwF+zdSv"
    "$bm^QpIc?|(pD0RR91;AD|ir)G#|N3^*R3Ztk?(VLyt7Z4&U6w#xIMn%*hu4HoMx~5>`U%jt>?e3F%UOoBwfq0WolMzX%DU{"
    "4U_?oCsBnlfxk<%u%oR(2F7R6bSMo}!-g{om6nir3@CM>e?!}KiT!=s3@Y~9KzAr$c1Jqlj@(kQ#|Kb;-#zx?>{x^q(IsU{p"
    "jL7W9wlhty$QZ%iCZB(fjxv>}jiQyiIMlBxiEkKG^wHZewqczL4Nd#TkUl_S{YT08cx=tq1JI8i6ww&y)(Yx9m?K+=P=PTt^"
    "qhgy*ULDwc(6!3CQ6ZI24qsXxwVaTXL$R?K?iQCulf$uiERJVZH<Kf=q06!OZnCrkj~f60P7qhr?5x1Q8eC5|{!PN)WQ)FW{"
    "vKQMJ=51p-u0h`pvC|I0000000000@VEH|kT-F?"
)
HEADER = b"\x93NUMPY\x01\x00B\x00{'descr': '<f8', 'fortran_order': False, 'shape': (4194304,), }  \n"
FILES = {
    "a bomb": surface(
        "a.npz",
        npz({"a": HEADER + bytes(2**25)}),
        r"bytes that unpack to \d+; allowed: at most 200 times",
        *HINTS,
    ),
    "many bombs": surface(
        "a.npz",
        npz({f"a{i}": HEADER + bytes(2**22) for i in range(64)}),
        r"bytes that unpack to \d+; allowed: at most 200 times",
        *HINTS,
    ),
    "a library that ends": surface("a.nc", ENDS, "a file that ends the program that opens it", *HINTS),
    "a claim": surface("a.npy", HEADER, r"4194304 points in 0 bytes", *HINTS),
}

KILOGRAMS = "frequency (Hz), damping ratio, modal mass (kg)\n"
WHEEL = f'{RAIL}[surface]\nspectrum = "iso3095"\n{ONE}'
STIFF = f'{WHEEL}damping = "{{}} N s/m"\n[numerics]\nhighest_frequency = "2 kHz"\n'
LIGHT = f'{BALL.replace("5 ms", "20 ms")}{ROUGH}{ONE}[ball]\nload = "5 N"\nmass = "{{}} kg"\n'
MODES = f'{WHEEL}[wheel]\nmodes = "modes.csv"\n'
ABSURD = {
    "damping of 1e6 N s/m": Absurd(STIFF.format("1e6"), 65e3, 2.0, {}),
    "damping of 1e9 N s/m": Absurd(STIFF.format("1e9"), 65e3, 2.0, {}),
    "a ball of 1e-5 kg": Absurd(LIGHT.format("1e-5"), 5.0, 5.0, {}),
    "200 modes of 100 kg": Absurd(
        MODES,
        65e3,
        3.0,
        {"modes.csv": KILOGRAMS + "".join(f"{300 + 20 * i}, 0.001, 100\n" for i in range(200))},
    ),
}

CORPUS = {
    f"{kind}: {name}": failure
    for kind, failures in {
        "quadratic": QUADRATIC,
        "without end": WITHOUT_END,
        "numbers": NUMBERS,
        "bodies": BODIES,
        "places": PLACES,
        "names": NAMES,
        "files": FILES,
    }.items()
    for name, failure in failures.items()
}
