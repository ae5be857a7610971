"""What is said of bearings in machines as people record them, of which the fault is known as they are made.

    python benchmarks/bearing_machines.py --seed 1 --count 8              # to develop on
    python benchmarks/bearing_machines.py --seed 77 --count 8 --rows x.json

Each kind of machine or record is made `--count` times with a fault of the outer ring, the inner ring, a ball
and none, and asked at its speed and at a wrong one. A part is named rightly where it is the one that is
struck, at the speed of its shaft; a doubt of the speed is all that does not confirm the one given.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from asperity.diagnostics import diagnose
from asperity.diagnostics.diagnosis import EVEN, RESOLVED
from asperity.structures.ball_bearing import BallBearing

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from faulty_signals import GEOMETRIES, faulty_signal

PARTS = ("outer", "inner", "ball", None)
BEARINGS = {name: BallBearing.named(name) for name in GEOMETRIES}
FOREIGN = {"6205": (7, 0.30), "6203": (11, 0.17)}
"""Bearing of another size on the same shaft: number of balls, and diameter of a ball over the pitch's."""
ALLOWED = 0.031
"""Share by which a speed that is named may be off, as in `bearing_verdicts`."""
WRONG = (0.5, 2.0, 0.7, 1.3, 0.9, 1.1)


@dataclass
class Machine:
    """A record that is made: what it is of, and how it is asked."""

    draw: np.random.Generator
    part: str | None
    bearing: str = "6205"
    speed: float = 30.0
    rate: float = 12_000.0
    duration: float = 2.0
    how: dict[str, object] = field(default_factory=dict)

    @property
    def time(self):
        """s, (n,)."""
        return np.arange(int(self.duration * self.rate)) / self.rate

    def tones(self, frequencies, amplitude):
        """Sum of tones with phases that are drawn, falling."""
        phases = self.draw.uniform(0.0, 2.0 * np.pi, len(frequencies))
        each = zip(range(1, 99), frequencies, phases, strict=False)
        return amplitude * sum(np.sin(2.0 * np.pi * f * self.time + p) / n**0.5 for n, f, p in each)

    def noise(self):
        """Of rms 1, (n,)."""
        return self.draw.normal(size=self.time.size)

    def signal(self, **more):
        """As `faulty_signal` makes it."""
        seed = int(self.draw.integers(2**31))
        how = {"bearing": self.bearing, "seed": seed} | self.how | more
        return faulty_signal(how.pop("part", self.part), self.speed, self.rate, self.duration, **how)


def drawn(part, draw):
    """A machine with a record of 1 to 10 s at 8 to 100 kHz."""
    machine = Machine(draw, part, str(draw.choice(list(GEOMETRIES))))
    machine.speed = float(np.exp(draw.uniform(np.log(10.0), np.log(60.0))))
    machine.rate = float(np.round(np.exp(draw.uniform(np.log(8e3), np.log(1e5)))))
    machine.duration = float(np.exp(draw.uniform(0.0, np.log(10.0))))
    machine.how = {"noise": draw.choice([0.1, 0.2, 0.35]), "slip": draw.uniform(0.0, 0.01)}
    machine.how |= {"jitter": draw.choice([0.002, 0.01]), "angle": np.radians(draw.uniform(0.0, 14.0))}
    machine.how |= {"resonance": draw.uniform(0.1, 0.4), "shaft": draw.choice([0.0, 0.05, 0.2])}
    return machine


def int16(machine):
    """Volts of a converter of 16 bits, of which a part is used."""
    signal = machine.signal()
    step = np.abs(signal).max() / machine.draw.choice([30, 300, 30_000])
    return np.round(signal / step) * (10.0 / 32_768)


def clipped(machine):
    signal = machine.signal()
    height = machine.draw.uniform(1.0, 3.0) * signal.std()
    return np.clip(signal, -height, height)


def hum(machine):
    grid = machine.draw.choice([50.0, 60.0])
    return machine.signal() + machine.tones(grid * np.arange(1, 9), machine.draw.choice([0.2, 1.0]))


def gear(machine):
    """A mesh that both shafts modulate."""
    teeth, other = machine.draw.integers(17, 60), machine.speed * machine.draw.uniform(0.2, 3.0)
    turned = 1.0 + machine.tones([machine.speed, 2.0 * machine.speed], 0.2) + machine.tones([other], 0.3)
    mesh = machine.tones(teeth * machine.speed * np.arange(1, 4), machine.draw.choice([0.3, 1.0]))
    return machine.signal() + turned * mesh


def two_shafts(machine):
    other = machine.speed * machine.draw.uniform(0.3, 3.0)
    return machine.signal() + machine.tones(other * np.arange(1, 9), machine.draw.choice([0.1, 0.4]))


def foreign_bearing(machine):
    """Another bearing on the shaft has the fault, or has one, too."""
    other = machine.signal(
        bearing=FOREIGN[machine.bearing], part=machine.draw.choice(PARTS[:3]), resonance=0.22
    )
    return other + (machine.signal() if machine.part else 0.0)


def looseness(machine):
    halves = machine.draw.choice([1.0, 0.5])
    return machine.signal() + machine.tones(halves * machine.speed * np.arange(1, 30), 0.4)


def unbalance(machine):
    return machine.signal() + machine.tones([machine.speed], machine.draw.choice([3.0, 20.0]))


def fluting(machine):
    """Burnt grooves: several spots of a ring, evenly spaced, of depths that differ."""
    signal = machine.signal()
    if machine.part in ("outer", "inner"):
        period = int(machine.rate / (3.6 * machine.speed * machine.draw.integers(3, 9)))
        signal = signal + sum(machine.draw.uniform(0.3, 1.0) * np.roll(signal, n * period) for n in range(5))
    return signal


def rub(machine):
    """A blow once in a turn."""
    blows = np.sin(np.pi * machine.speed * machine.time) ** 2 > 0.995
    return machine.signal() + machine.draw.choice([0.7, 2.0]) * blows * machine.noise()


def flow(machine):
    """Broadband noise that the shaft modulates, as of a fan or pump."""
    turned = 1.0 + 0.6 * np.sin(2.0 * np.pi * machine.speed * machine.time)
    blades = 1.0 + 0.4 * np.sin(2.0 * np.pi * machine.draw.integers(5, 9) * machine.speed * machine.time)
    return machine.signal() + 0.3 * turned * blades * machine.noise()


def varying_speed(machine):
    """The shaft turns by up to 2 % faster and slower: time is bent."""
    time, slow = machine.time, machine.draw.uniform(0.2, 1.0)
    bent = time + 0.02 / (2.0 * np.pi * slow) * np.sin(2.0 * np.pi * slow * time)
    return np.interp(bent, time, machine.signal())


def dropouts(machine):
    """A wireless sensor: zeros, held values, straight lines, or blocks that are left out."""
    signal = machine.signal()
    kind = machine.draw.choice(["zeros", "held", "line", "lost"])
    size = int(machine.draw.integers(20, 400))
    firsts = np.sort(machine.draw.integers(100, signal.size - 500, machine.draw.integers(1, 12)))
    if kind == "lost":
        places = np.concatenate([np.arange(first, first + size) for first in firsts])
        return np.delete(signal, np.unique(places))
    for first in firsts:
        ends = {"zeros": (0.0, 0.0), "held": (signal[first - 1],) * 2}
        low, high = ends.get(kind, (signal[first - 1], signal[first + size]))
        signal[first : first + size] = np.linspace(low, high, size)
    return signal


def resampled(machine):
    """As another program left it; the rate follows."""
    from scipy.signal import resample, resample_poly

    signal, kind = machine.signal(), machine.draw.integers(6)
    up, down = ((4, 5), (1, 2), (3, 2), (4, 1), (0, 0), (1, 1))[kind]
    if kind == 4:  # by a Fourier transform
        size = signal.size * 4 // 5
        machine.rate *= size / signal.size
        return resample(signal, size)
    if kind == 5:  # a low-pass as of a sound file
        lines = np.fft.rfft(signal)
        lines[lines.size * 2 // 3 :] = 0.0
        return np.fft.irfft(lines, signal.size).astype(np.float32).astype(float)
    machine.rate *= up / down
    return resample_poly(signal, up, down)


def short(machine):
    machine.duration, machine.rate = 0.1, 51_200.0
    return machine.signal()


KINDS = {
    "1 to 10 s at 8 to 100 kHz": Machine.signal, "0.1 s": short, "volts of 16 bits": int16,
    "clipped": clipped, "mains hum": hum, "gear mesh": gear, "two shafts": two_shafts,
    "another bearing on the shaft": foreign_bearing, "looseness": looseness, "unbalance": unbalance,
    "fluting": fluting, "rub once in a turn": rub, "flow noise": flow,
    "speed that varies by 2 %": varying_speed, "missing samples": dropouts, "resampled": resampled,
}  # fmt: skip
OFF = (0.95, 0.98, 0.99, 1.01, 1.02, 1.05)


def asked(kinds, seed, count):
    """Yield what is said of each machine: at its speed, told 1, 2 or 5 % wrong, and at a wrong speed."""
    for number, name in enumerate(KINDS):
        if name not in kinds:
            continue
        for part in PARTS:
            for n in range(count):
                draw = np.random.default_rng([seed, number, PARTS.index(part), n])
                machine = drawn(part, draw)
                signal = KINDS[name](machine)
                for how, factor in (
                    ("right", 1.0),
                    ("near", draw.choice(OFF)),
                    ("wrong", _wrong(draw)),
                ):
                    yield {"kind": name, "n": n, "asked": how, "factor": float(factor)} | _said(
                        signal, machine, float(factor)
                    )


def _wrong(draw):
    return draw.choice(WRONG) if draw.random() < 0.6 else np.exp(draw.uniform(np.log(1 / 6), np.log(6.0)))


def _said(signal, machine, factor):
    """What is decided, and whether that is right."""
    about = {"part": machine.part, "rate": machine.rate, "speed": machine.speed, "how": str(machine.how)}
    about["bearing"] = machine.bearing
    try:
        found = diagnose(signal, machine.rate, BEARINGS[machine.bearing].tones(), machine.speed * factor)
    except ValueError as refused:
        return about | {"said": "refused", "confidence": 0.0, "doubted": True, "why": str(refused)}
    named = [each.part for each in (*found.parts, *found.alike)]
    right = named == [machine.part] and abs(found.speed / machine.speed - 1.0) <= ALLOWED
    said = ("rightly" if right else "wrongly") if named else "not"
    return about | {
        "said": said, "named": named, "confidence": found.confidence, "at": found.speed,
        "doubted": found.speed_is != "confirmed", "speed_is": found.speed_is, "blows": found.blows,
        "basis": found.basis.kind, "support": found.basis.support, "margin": found.basis.margin,
        "depth": found.basis.depth, "turns": found.turns, "otherwise": found.otherwise is not None,
        "doubts": found.doubts,
    }  # fmt: skip


def table(rows) -> None:
    """Print by kind and speed how often a part is named rightly, wrongly, not, and the speed doubted."""
    columns = (
        "fault: rightly",
        "wrongly",
        "not",
        "speed doubted",
        "sound: a part named",
        "not",
        "speed doubted",
    )
    print(f"| machine or record | speed | {' | '.join(columns)} |\n|---|---|{'---:|' * 7}")
    for kind in (*KINDS, "all"):
        for how in ("right", "near", "wrong"):
            own = [row for row in rows if row["asked"] == how and kind in (row["kind"], "all")]
            cells = []
            for struck, said in ((True, ("rightly", "wrongly", "not")), (False, ("wrongly", "not"))):
                of = [row for row in own if bool(row["part"]) is struck]
                count = Counter(row["said"] for row in of)
                count["not"] += count["refused"]
                cells += [count[each] for each in said] + [sum(row["doubted"] for row in of)]
            if own:
                print(f"| {kind} | {how} | {' | '.join(str(each or '–') for each in cells)} |")
    sure = [row for row in rows if row["said"] in ("rightly", "wrongly")]
    for low, high in ((0.0, 0.5), (0.5, 0.85), (0.85, 0.95), (0.95, 1.0)):
        own = [row for row in sure if low < row["confidence"] <= high]
        if own:
            mean = 100.0 * np.mean([row["confidence"] for row in own])
            right = sum(row["said"] == "rightly" for row in own)
            said = f"{100 * low:.0f} to {100 * high:.0f} % sure"
            print(f"named, {said}: {len(own)}, mean {mean:.0f} %, right {right}")


def no_sign(rows) -> None:
    """Print how often a bearing is sound of which no sign of a fault is told, as if half of all had one, and
    four of five speeds were right."""
    struck = Counter((bool(row["part"]), row["asked"] == "right") for row in rows)
    share = {key: (0.8 if key[1] else 0.2) / count for key, count in struck.items()}
    for kind in ("sound", "nothing"):
        own = [
            row for row in rows if row["said"] == "not" and row["basis"] == kind and row["turns"] >= RESOLVED
        ]
        for even in (True, False):  # of those that something may hide in, and others
            told = [row for row in own if (row["confidence"] <= EVEN) is even]
            if not told:
                continue
            weight = np.array([share[bool(row["part"]), row["asked"] == "right"] for row in told])
            sound = np.array([not row["part"] for row in told])
            mean = 100.0 * np.average([row["confidence"] for row in told], weights=weight)
            right = 100.0 * np.average(sound, weights=weight)
            count = f"{sum(sound)} of {len(told)}"
            print(f"no sign ({kind}), {mean:.0f} % sure: {count} sound, {right:.0f} % with half faulty")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, default=8)
    parser.add_argument("--kinds", nargs="*", default=list(KINDS))
    parser.add_argument("--rows", type=Path, help="JSON of all that is said")
    chosen = parser.parse_args()
    rows = list(asked(chosen.kinds, chosen.seed, chosen.count))
    if chosen.rows:
        chosen.rows.write_text(json.dumps(rows, default=float))
    table(rows)
    no_sign(rows)


if __name__ == "__main__":
    main()
