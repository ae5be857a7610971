"""How often the part of a bearing that is struck is named rightly, wrongly or not, at right and wrong speeds.

    python benchmarks/bearing_verdicts.py DATA --save after.json    # of the package that Python finds
    PYTHONPATH=old/src python benchmarks/bearing_verdicts.py DATA --save before.json
    python benchmarks/bearing_verdicts.py DATA --page before.json after.json
    python benchmarks/bearing_verdicts.py DATA --calibrate    # confidence, on pieces of the records
    python benchmarks/bearing_verdicts.py DATA --lengths 8    # pieces of 2 to 50 turns
    python benchmarks/bearing_verdicts.py DATA --attack       # records that are disturbed
    python benchmarks/bearing_verdicts.py DATA --made 40      # signals that are made, of each part

DATA is a folder with cwru_6205_12k.npz, mfpt_nice_48k.npz and hit_6205_51k.npz: records of one bearing each,
whose fault is in its name. `asperity bearing` is called on every whole record with its speed and sampling
rate, and with wrong ones; what its last line says is counted. `--calibrate` cuts the records into pieces,
asks at right and at wrong speeds, and fits the coefficients of `asperity.diagnostics.confidence`, once for
all records and once without each of them, from which the table of how often a confidence is right is made.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np

from asperity.diagnostics import diagnose, diagnose_together
from asperity.diagnostics.confidence import Basis
from asperity.structures.ball_bearing import BallBearing

NICE = """
balls = 8
ball_diameter = "5.97 mm"
pitch_diameter = "31.62 mm"
inner_conformity = 0.52
outer_conformity = 0.52
clearance = "0 um"
"""
SETS = {
    "cwru": ("cwru_6205_12k.npz", 12_000.0),
    "mfpt": ("mfpt_nice_48k.npz", 48_828.0),
    "hit": ("hit_6205_51k.npz", 51_200.0),
}
SPEEDS = (1.0, 0.97, 1.03, 0.9, 1.1, 0.7, 1.3, 0.5, 2.0, 60.0)
RATES = (0.25, 0.5, 0.8, 1.25, 2.0, 4.0)
PIECES = (
    *((turns, 3, 0.0, 1) for turns in (2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 12.0, 20.0, 35.0)),
    (np.inf, 1, 0.0, 6),
    (np.inf, 1, 2.0, 2),
    (20.0, 1, 4.0, 2),
    (6.0, 1, 2.0, 1),
)
"""Turns of the shaft at most, number of pieces of each record, noise that is added, in rms of the record, and
how many wrong speeds."""
WRONG = (0.16, 0.25, 0.5, 0.662, 0.7, 0.9, 0.97, 1.03, 1.1, 1.3, 1.51, 2.0, 3.6, 4.0, 6.28)
"""Factors by which they are wrong, among them those at which one ring has the lines of the other, at which
the shaft has those of the outer ring, and radians for turns."""
ALLOWED = 0.031
"""Share by which a speed that is named may be off the nominal one: those of these rigs are so far."""
PART = re.compile(r"lines of the (outer|inner|ball)")
DOUBT = re.compile(r"[Ll]ines? of the shaft")


def records(folder: Path):
    """Yield set, name, file, signal, sampling rate, nominal speed and part of each record."""
    for of, (file, rate) in SETS.items():
        with np.load(folder / file) as data:
            for name in data.files:
                part = (
                    "outer"
                    if "OR" in name or "outer" in name
                    else "inner"
                    if "I" in name or "inner" in name
                    else None
                )
                number = {"cwru": name.split("_")[0], "mfpt": "1500", "hit": name.split("_")[-1]}[of]
                yield of, name, folder / file, data[name].astype(float), rate, float(number) / 60.0, part


# --- what the last line says of whole records


def last_lines(folder: Path) -> list[dict[str, object]]:
    """What the command says of every record, at every speed and rate."""
    from click.testing import CliRunner

    from asperity.cli import main

    asked = [(speed, 1.0) for speed in SPEEDS] + [(1.0, rate) for rate in RATES]
    found = []
    with tempfile.TemporaryDirectory() as scratch:
        (nice := Path(scratch) / "nice.toml").write_text(NICE)
        for of, name, file, _, rate, speed, part in records(folder):
            for by_speed, by_rate in asked:
                words = [
                    "bearing",
                    str(nice) if of == "mfpt" else "6205",
                    "--speed",
                    f"{speed * by_speed:.8g} Hz",
                ]
                words += ["--signal", str(file), "--array", name, "--rate", f"{rate * by_rate:.8g} Hz"]
                said = CliRunner().invoke(main, words)
                last = said.output.strip().splitlines()[-1]
                row = {
                    "set": of,
                    "record": name,
                    "part": part,
                    "speed": by_speed,
                    "rate": by_rate,
                    "said": last,
                }
                found.append(
                    row | {"outcome": outcome(last, part, speed * by_rate, (by_speed, by_rate) != (1.0, 1.0))}
                )
    return found


def outcome(said: str, part: str | None, speed: float, wrong: bool) -> str:
    """What a last line does: names the part "rightly" or "wrongly" or "not", or says so "in doubt" of the
    speed."""
    named, doubted = sorted(set(PART.findall(said))), bool(DOUBT.search(said))
    if not named:
        return "speed doubted, no part" if doubted else "no part"
    right = named == [part]
    if elsewhere := re.search(r"but at ([\d.]+) Hz", said):
        right = right and abs(float(elsewhere[1]) / speed - 1.0) <= ALLOWED
        return "speed doubted, part right" if right else "speed doubted, part wrong"
    if doubted:
        return "if the speed is right: right" if right else "if the speed is right: wrong"
    return "part right" if right else "part wrong"


OUTCOMES = ("part right", "part wrong", "no part", "if the speed is right: right",
            "if the speed is right: wrong", "speed doubted, part right",
            "speed doubted, part wrong", "speed doubted, no part")  # fmt: skip


def page(before: Path, after: Path) -> None:
    """Print tables of outcomes before and after."""
    rows = {name: json.loads(path.read_text()) for name, path in (("before", before), ("after", after))}
    kinds = {
        "fault, right speed and rate": lambda row: row["part"] and row["speed"] == row["rate"] == 1.0,
        "no fault, right speed and rate": lambda row: not row["part"] and row["speed"] == row["rate"] == 1.0,
        "fault, speed ±3 %": lambda row: row["part"] and row["speed"] in (0.97, 1.03),
        "fault, speed ±10 %": lambda row: row["part"] and row["speed"] in (0.9, 1.1),
        "fault, speed ±30 %": lambda row: row["part"] and row["speed"] in (0.7, 1.3),
        "fault, speed half or twice": lambda row: row["part"] and row["speed"] in (0.5, 2.0),
        "no fault, wrong speed": lambda row: not row["part"] and row["speed"] not in (1.0, 60.0),
        "fault, wrong rate": lambda row: row["part"] and row["rate"] != 1.0,
        "no fault, wrong rate": lambda row: not row["part"] and row["rate"] != 1.0,
    }
    print(f"| asked with | | {' | '.join(OUTCOMES)} |")
    print(f"|---|---|{'---:|' * len(OUTCOMES)}")
    for kind, held in kinds.items():
        for name, found in rows.items():
            count = Counter(row["outcome"] for row in found if held(row))
            cells = [str(count[each] or "–") for each in OUTCOMES]
            print(f"| {kind if name == 'before' else ''} | {name} | {' | '.join(cells)} |")
    print("\n| record | fault | right speed and rate, before | after |\n|---|---|---|---|")
    both = zip(rows["before"], rows["after"], strict=True)
    for old, new in both:
        if new["speed"] == new["rate"] == 1.0:
            print(
                f"| {new['set']} {new['record']} | {new['part'] or 'none'} | {old['said']} | {new['said']} |"
            )


# --- how sure, on pieces of records


def pieces(folder: Path, seed: int = 1):
    """Yield what is decided of pieces of all records at right and wrong speeds, without a confidence."""
    draw, bearings = np.random.default_rng(seed), {"mfpt": BallBearing(8, 5.97e-3, 31.62e-3)}
    for of, name, _, signal, rate, speed, part in records(folder):
        tones = bearings.get(of, BallBearing.named("6205")).tones()
        for turns, count, noise, wrong in PIECES:
            for _ in range(count if part else 4 * count):  # of few sound records more pieces
                size = int(min(turns / speed * rate, signal.size))
                first = draw.integers(0, signal.size - size + 1)
                piece = signal[first : first + size]
                piece = piece + noise * signal.std() * draw.normal(size=size)
                about = {"set": of, "record": name, "made": False, "noise": noise}
                for factor in (1.0, *draw.choice(WRONG, wrong, False)):
                    yield from asked(piece, rate, tones, speed, float(factor), part, about)


def made_pieces(count: int, seed: int = 2):
    """Yield the same of signals that `tests/faulty_signals.py` makes, with all that disturbs."""
    draw, tones = np.random.default_rng(seed), BallBearing.named("6205").tones()
    for number in range(count):
        for part in ("outer", "inner", "ball", None):
            speed, rate = draw.uniform(15.0, 45.0), draw.choice([12_000.0, 25_600.0])
            turns = draw.choice([3.0, 5.0, 8.0, 15.0, 30.0, 60.0, 120.0])
            signal, noise = made_signal(part, speed, rate, turns / speed, draw, number)
            about = {"set": "made", "record": f"{number % 20}", "made": True, "noise": noise}
            for factor in (1.0, draw.choice(WRONG)):
                yield from asked(signal, rate, tones, speed, float(factor), part, about)


def made_signal(part, speed, rate, duration, draw, seed):
    """A made signal and its noise, rms."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
    from faulty_signals import faulty_signal

    noise = draw.choice([0.1, 0.3, 0.6])
    how = {"slip": draw.uniform(0.0, 0.01), "jitter": draw.choice([0.002, 0.01, 0.02]), "seed": seed}
    how |= {"angle": np.radians(draw.uniform(0.0, 14.0)), "resonance": draw.uniform(0.1, 0.4)}
    how |= {"shaft": draw.choice([0.02, 0.2]), "hum": draw.choice([0.0, 0.3])}
    how |= {"foreign": [(draw.uniform(1.9, 2.1) * speed, 0.3)]} if draw.random() < 0.5 else {}
    how |= {"compliance": 0.3} if part is None and draw.random() < 0.5 else {}
    how |= {"unlike": draw.uniform(0.0, 1.0)} if part == "ball" else {}
    return faulty_signal(part, speed, rate, duration, noise=noise, **how), float(noise)


def asked(signal, rate, tones, speed, factor, part, about):
    """Yield what is decided of a signal at a factor of its speed, and whether that is right; nothing of one
    that is too short for a tone."""
    several = signal if isinstance(signal, list) else [signal]
    try:
        found = diagnose_together(several, rate, tones, speed * factor)
    except ValueError:
        return
    basis = {name: getattr(found.basis, name) for name in ("kind", "turns", "margin", "support", "depth")}
    right = _right(found, part, speed, factor)
    length = several[0].size / rate * speed
    named = [each.part for each in (*found.parts, *found.alike)]
    yield about | basis | {
        "part": part, "sound": part is None, "length": length, "factor": factor, "right": right,
        "named": named, "confidence": found.confidence, "undecided": found.undecided,
        "doubted": found.doubted,
    }  # fmt: skip


def _right(found, part: str | None, speed: float, factor: float) -> bool:
    """Whether what is said is so."""
    right_speed = factor == 1.0
    named = [each.part for each in found.parts]
    if named:
        return named == [part] and abs(found.parts[0].speed / speed - 1.0) <= ALLOWED
    if found.blows:
        return not right_speed
    if found.speed_is == "confirmed" or found.others:
        return part is None
    return part is None or not right_speed  # "if it is right", it says


def described(rows):
    """What the log-odds of rows are linear in, (rows, 5)."""
    names = "kind", "turns", "margin", "support", "depth"
    values = [np.append(1.0, Basis(*(row[name] for name in names)).features) for row in rows]
    return np.array(values).reshape(-1, 5)


def fitted(rows, weight, kinds):
    """Coefficients by kind: a logistic line with a penalty; of kinds that name no part over the turns alone.

    Those of a ball by made signals too, as none was measured, and those of no part, as made faults hide in
    noise more often; of all other kinds by measured ones.
    """
    from scipy.optimize import minimize

    found = {}
    for kind in kinds:
        own = np.array([row["kind"] == kind and (kind in BY_MADE or not row["made"]) for row in rows])
        kept = [row for row, of in zip(rows, own, strict=True) if of]
        right = np.array([row["right"] for row in kept], dtype=float)
        seen, counts = described(kept), weight[own]

        def loss(a, seen=seen, right=right, counts=counts):
            line = seen @ a
            fit = (counts * (np.logaddexp(0.0, line) - right * line)).sum()
            prior = np.logaddexp(0.0, a[0]) - 0.5 * a[0]  # one more, half of it right
            return fit + prior + 0.5 * (a[1:] ** 2).sum()

        others = (0.0, None) if kind in WITH_FEATURES else (0.0, 0.0)
        found[kind] = minimize(loss, np.zeros(5), bounds=[(None, None), *[others] * 3, (0.0, None)]).x
    return found


BY_MADE = ("ball", "nothing", "sound")
WITH_FEATURES = ("ball", "fault", "fault, shaft not found", "elsewhere")


def calibrate(rows) -> None:
    """Print coefficients, and how often what is said with a confidence is right, each record by the
    others."""
    rows = [row for row in rows if not (row["undecided"] or row["doubted"])]
    kinds, weight = sorted({row["kind"] for row in rows}), weights(rows)
    for kind, values in fitted(rows, weight, kinds).items():
        own = [row for row in rows if row["kind"] == kind and (kind in BY_MADE or not row["made"])]
        count = f"{sum(row['right'] for row in own):.0f} of {len(own)}"
        print(f'    "{kind}": ({", ".join(f"{each:.2f}" for each in values)}),  # {count}')
    seen, right = described(rows), np.array([row["right"] for row in rows], dtype=float)
    for group in ("record", "set"):
        names = np.array([row["set"] + (row["record"] if group == "record" else "") for row in rows])
        said = np.full(len(rows), np.nan)
        for name in sorted(set(names)):
            if group == "set" and name == "made":
                continue
            others = [row for row, of in zip(rows, names, strict=True) if of != name]
            lines = fitted(others, weights(others), kinds)
            for at in np.flatnonzero(names == name):
                odds = seen[at] @ lines[rows[at]["kind"]]
                said[at] = min(max(1.0 / (1.0 + np.exp(-odds)), 0.03), 0.97)
        made_too = np.array([row["made"] for row in rows])
        for title, own in (("measured", ~made_too), ("made", made_too)):
            if np.isfinite(said[own]).all():
                _print_calibration(f"{title}, without the {group}", said[own], right[own], weight[own])


def _print_calibration(title, said, right, weight) -> None:
    """Print how often what is said with a confidence is right."""
    print(f"\n| {title}: said | times | mean said | right |\n|---|---:|---:|---:|")
    for low, high in ((0.0, 0.5), (0.5, 0.7), (0.7, 0.85), (0.85, 0.95), (0.95, 1.0)):
        own = (said >= low) & (said < high)
        if own.any():
            mean, share = (100 * np.average(each[own], weights=weight[own]) for each in (said, right))
            print(f"| {100 * low:.0f} to {100 * high:.0f} % | {own.sum()} | {mean:.0f} % | {share:.0f} % |")


def weights(rows):
    """Of rows, as if half of all bearings had a fault, and four of five speeds were right: of measured ones
    and of made ones."""
    kinds = Counter((row["made"], row["sound"], row["factor"] == 1.0) for row in rows)
    count = Counter(row["made"] for row in rows)
    shares = {kind: 0.5 * (0.8 if kind[2] else 0.2) * count[kind[0]] / n for kind, n in kinds.items()}
    return np.array([shares[row["made"], row["sound"], row["factor"] == 1.0] for row in rows])


# --- pieces of the records by their length


LENGTHS = (2, 3, 4, 5, 6, 8, 10, 14, 20, 30, 50)


def lengths(folder: Path, offsets: int) -> None:
    """Print what is said of pieces of all records by their turns, at the right speed, and how sure it is."""
    bearings = {"mfpt": BallBearing(8, 5.97e-3, 31.62e-3)}
    rows = []
    for of, name, _, signal, rate, speed, part in records(folder):
        tones = bearings.get(of, BallBearing.named("6205")).tones()
        for turns in LENGTHS:
            size = int(turns / speed * rate)
            count = offsets * (1 if part else 4)
            firsts = (
                np.unique(np.linspace(0, signal.size - size, count).astype(int))
                if size <= signal.size
                else ()
            )
            about = {"set": of, "record": name, "made": False, "noise": 0.0}
            for first in firsts:
                piece = signal[first : first + size]
                rows += [row | {"turns": turns} for row in asked(piece, rate, tones, speed, 1.0, part, about)]
    columns = "turns", "fault: pieces", "right part", "wrong part", "no sign", "too short", "sound: pieces"
    print(f"| {' | '.join((*columns, 'none named', 'a part named', 'said of verdicts', 'right'))} |")
    print(f"|---:|{'---:|' * 10}")
    for turns in LENGTHS:
        own = [row for row in rows if row["turns"] == turns]
        faulty, sound = ([row for row in own if row["sound"] is wanted] for wanted in (False, True))
        right = sum(row["right"] for row in faulty)
        wrong = sum(bool(row["named"]) and not row["right"] for row in faulty)
        short = sum(row["undecided"] for row in faulty)
        named = sum(not row["right"] for row in sound)
        said = [row for row in own if not row["undecided"]]
        sure, true = (100.0 * np.mean([row[what] for row in said]) for what in ("confidence", "right"))
        cells = [turns, len(faulty), right, wrong, len(faulty) - right - wrong - short, short, len(sound)]
        cells += [len(sound) - named, named, f"{sure:.0f} %", f"{true:.0f} %"]
        print(f"| {' | '.join(str(each or '–') for each in cells)} |")


# --- records that are disturbed


def disturbances(signal, rate, speed, draw):
    """Yield what is done to a record, its signal then, and its sampling rate."""
    from scipy.signal import resample_poly

    time, rms = np.arange(signal.size) / rate, signal.std()
    yield "as it is", signal, rate
    for noise in (0.5, 1.0, 2.0):
        yield f"noise of {noise:g} rms", signal + noise * rms * draw.normal(size=signal.size), rate
    foreign = sum(np.sin(2 * np.pi * 2.03 * speed * n * time) / n for n in (1, 2))
    yield "a foreign line at 2.03 times the speed, its second", signal + rms * foreign, rate
    hum = sum(np.sin(2 * np.pi * 50.0 * n * time + n) / n for n in (1, 2, 3, 5))
    yield "hum of 50 Hz", signal + rms * hum, rate
    yield "8 bits", np.round(signal / np.abs(signal).max() * 127.0), rate
    yield "8 bits, of which 4 are used", np.round(signal / np.abs(signal).max() * 8.0), rate
    for height in (4.0, 2.0, 1.0):
        yield f"clipped at {height:g} rms", np.clip(signal, -height * rms, height * rms), rate
    yield "resampled by 4/5", resample_poly(signal, 4, 5), 0.8 * rate
    yield "resampled by 1/2", resample_poly(signal, 1, 2), 0.5 * rate
    broken = signal.copy()
    broken[signal.size // 3 : signal.size // 3 + 500] = np.nan
    broken[:: signal.size // 40] = np.nan
    yield "a gap, and 40 samples missing", broken, rate
    yield "an offset of 20 rms", signal + 20.0 * rms, rate
    cuts = np.array_split(signal, 6)
    yield "six files together", cuts, rate


def attacked(folder: Path) -> None:
    """Print what is said of disturbed records at their speeds: part, and how sure."""
    bearings, draw = {"mfpt": BallBearing(8, 5.97e-3, 31.62e-3)}, np.random.default_rng(4)
    rows: dict[str, list[dict[str, object]]] = {}
    for of, name, _, signal, rate, speed, part in records(folder):
        tones = bearings.get(of, BallBearing.named("6205")).tones()
        for kind, disturbed, sampled in disturbances(signal, rate, speed, draw):
            about = {"set": of, "record": name, "made": False, "noise": 0.0}
            rows.setdefault(kind, []).extend(asked(disturbed, sampled, tones, speed, 1.0, part, about))
    columns = "fault: right part", "wrong part", "no sign", "sound: none named", "a part named"
    print(f"| what is done to the record | {' | '.join((*columns, 'said, of verdicts', 'right'))} |")
    print(f"|---|{'---:|' * 7}")
    for kind, own in rows.items():
        faulty, sound = ([row for row in own if row["sound"] is wanted] for wanted in (False, True))
        right = sum(row["right"] for row in faulty)
        wrong = sum(bool(row["named"]) and not row["right"] for row in faulty)
        named = sum(not row["right"] for row in sound)
        sure, true = (100.0 * np.mean([row[what] for row in own]) for what in ("confidence", "right"))
        cells = right, wrong, len(faulty) - right - wrong, len(sound) - named, named
        counts = " | ".join(str(each or "–") for each in cells)
        print(f"| {kind} | {counts} | {sure:.0f} % | {true:.0f} % |")
        for row in own:
            if not row["right"]:
                print(f"{row['set']} {row['record']}: {row}", file=sys.stderr)


# --- signals that are made


def made(count: int) -> None:
    """Print how often the part is named of signals that `tests/faulty_signals.py` makes, with all that
    disturbs."""
    tones, draw = BallBearing.named("6205").tones(), np.random.default_rng(5)
    counts: dict[tuple[str, float, bool], Counter[str]] = {}
    sure: list[tuple[float, bool]] = []
    for seed in range(count):
        for part in ("outer", "inner", "ball", None):
            speed, rate = draw.uniform(15.0, 45.0), draw.choice([12_000.0, 25_600.0])
            signal, noise = made_signal(part, speed, rate, draw.choice([1.0, 2.0, 4.0]), draw, seed)
            for factor in (1.0, draw.choice([0.5, 0.7, 0.9, 0.97, 1.03, 1.1, 1.3, 2.0])):
                found = diagnose(signal, rate, tones, speed * factor)
                named = [each.part for each in (*found.parts, *found.alike)]
                right = named == [part] and abs(found.speed / speed - 1.0) <= ALLOWED
                said = ("rightly" if right else "wrongly") if named else "not"
                counts.setdefault((part or "none", noise, factor == 1.0), Counter())[said] += 1
                sure += [(found.confidence, right)] if named else []
    print(
        "| struck | noise, rms | right speed: rightly | wrongly | not | wrong one: rightly | wrongly | not |"
    )
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    for part, noise in sorted({key[:2] for key in counts}):
        both = [counts.get((part, noise, told), Counter()) for told in (True, False)]
        cells = [str(each[said] or "–") for each in both for said in ("rightly", "wrongly", "not")]
        print(f"| {part} | {noise:g} | {' | '.join(cells)} |")
    said, right = map(np.array, zip(*sure, strict=True))
    mean = 100 * said.mean()
    print(f"\nOf {said.size} that name a part, {mean:.0f} % sure on the mean, {right.sum()} are right.")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("--save", type=Path)
    parser.add_argument("--page", nargs=2, type=Path, metavar=("BEFORE", "AFTER"))
    parser.add_argument("--calibrate", action="store_true")
    parser.add_argument("--made", type=int, metavar="COUNT")
    parser.add_argument("--attack", action="store_true", help="records with noise, hum, clipped, …")
    parser.add_argument("--lengths", type=int, metavar="OFFSETS", help="pieces of each length and record")
    parser.add_argument("--rows", type=Path, help="of --calibrate: written there, or read from it")
    chosen = parser.parse_args()
    if chosen.save:
        chosen.save.write_text(json.dumps(last_lines(chosen.data), indent=0))
    if chosen.page:
        page(*chosen.page)
    if chosen.lengths:
        lengths(chosen.data, chosen.lengths)
    if chosen.attack:
        attacked(chosen.data)
    if chosen.made:
        made(chosen.made)
    if chosen.calibrate:
        if chosen.rows and chosen.rows.exists():
            rows = json.loads(chosen.rows.read_text())
        else:
            found = (*pieces(chosen.data), *made_pieces(80))
            rows = [json.loads(json.dumps(row, default=float)) for row in found]
            if chosen.rows:
                chosen.rows.write_text(json.dumps(rows))
        calibrate(rows)


if __name__ == "__main__":
    main()
