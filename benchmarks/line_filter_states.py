"""Where a line filter is read: at the state of the contact, or counted from the mean plane, against `direct`.

    python benchmarks/line_filter_states.py [rails | balls | flight]

rolls `direct`, `areal`, `table` and the two laws of a filtered line, these also with states counted from the
mean plane, over rails at and above the limit of ISO 3095 and over rough balls, with seeds that nothing was
fitted to. Of each record it prints how far the one-third octaves of the force from 100 Hz to 5 kHz are from
`direct`, and the share of time lost. As paths part where contact is lost, it also asks each law for the force
on the course of approach that `direct` took: the rms of what it is off, over the dynamic force of `direct`,
the slope of its regression on the force of `direct`, and its mean over that of `direct`.
`flight` averages the energies of eight paths of each of two balls, without `table`, as one path says little.
"""

from __future__ import annotations

import sys
import warnings
from dataclasses import replace

import numpy as np

from asperity import laws
from asperity.case.beam import BallOnBeam
from asperity.case.bodies import WheelOnRail
from asperity.laws.layout import force
from asperity.progress import progress_bar
from asperity.reference.cnossos import rail_roughness
from asperity.running import prepare_case
from asperity.scenes.compute import compute
from asperity.spectra import band_levels, psd

FILTERED, OLD = ("shifted", "hertz-filtered"), "-mean-plane"
LAWS = ("direct", *(name + suffix for name in FILTERED for suffix in (OLD, "")), "areal", "table")
LOW, HIGH, SEGMENT = 100.0, 5000.0, 0.1  # Hz, Hz, s
BALLS = (  # seed, load, N, rms, longest and shortest wave
    (7101, 30, "0.1 um", "0.4 mm", "80 um"),
    (7102, 30, "1 um", "2 mm", "80 um"),
    (7103, 30, "1 um", "0.8 mm", "80 um"),
    (7104, 10, "0.3 um", "0.4 mm", "60 um"),
    (7105, 5, "0.15 um", "0.4 mm", "40 um"),
    (7106, 30, "3 um", "2 mm", "80 um"),
)
FLIGHT = ((7201, 5, "0.15 um", "0.4 mm", "40 um"), (7301, 30, "1 um", "0.8 mm", "80 um"))


def cases():
    """Yield the names and cases that were asked for."""
    asked = sys.argv[1:] or ["rails", "balls"]
    wavelengths, limit = rail_roughness("iso3095")
    for above in (0, 10, 15) if "rails" in asked else ():
        for seed in (7001, 7002):
            spectrum = np.column_stack([wavelengths, limit + above])
            yield (
                f"rail +{above} dB, {seed}",
                WheelOnRail(
                    laws=LAWS,
                    seed=seed,
                    duration="0.12 s",
                    settling="20 ms",
                    surface={"spectrum": spectrum},
                    wheel={"section": "rigid"},
                ),
            )
    for given in BALLS if "balls" in asked else ():
        seed, load, rms, longest, _ = given
        yield f"{load} N, {rms}, waves to {longest}, {seed}", ball(*given, LAWS)


def ball(seed, load, rms, longest, shortest, names) -> BallOnBeam:
    """A ball on a rough beam."""
    surface = {"rms": rms, "longest": longest, "shortest": shortest}
    body = {"load": f"{load} N"}
    return BallOnBeam(laws=names, seed=seed, start="0.4 m", duration="0.2 s", surface=surface, ball=body)


def levels(signal, step):
    """Third-octave levels of a force."""
    segment = min(signal.size, round(SEGMENT / step))
    return band_levels(*psd(signal, step, segment=segment), low=LOW, high=HIGH)[1]


def rolled(case):
    """Roll a case: what was computed."""
    with progress_bar() as progress:
        return compute(prepare_case(case), progress)


def away_of(found, wanted) -> str:
    """Say how far levels are from those of `direct`, dB: rms, mean and worst."""
    away = found - wanted
    return f"{np.sqrt(np.mean(away**2)):.2f} | {away.mean():+.2f} | {away[np.argmax(np.abs(away))]:+.1f}"


def compare(name, case) -> None:
    """Print the lines of a case: records, and forces on the course of `direct`."""
    computed, step = rolled(case), case.time_step
    direct = computed.runs["direct"]
    followed = direct.contact_force[0]
    wanted = levels(followed, step)
    for law, run in computed.runs.items():
        line = f"| {name} | {law} | {100 * (1.0 - run.in_contact.mean()):.1f} | "
        line += f"{away_of(levels(run.contact_force[0], step), wanted)} | "
        if law != "direct":
            course = force(computed.build(law), direct.positions[0], direct.relative_displacement[0])
            off = np.sqrt(np.mean((course - followed) ** 2)) / followed.std()
            slope = np.cov(course, followed)[0, 1] / followed.var()
            line += f"{100 * off:.0f} | {slope:.2f} | {course.mean() / followed.mean():.2f} |"
        print(line, flush=True)


def average(first, load, rms, longest, shortest) -> None:
    """Print the lines of eight paths of a ball: levels of their mean energies."""
    energies, lost = {law: [] for law in LAWS[:-1]}, {law: [] for law in LAWS[:-1]}
    for seed in range(first, first + 8):
        case = ball(seed, load, rms, longest, shortest, LAWS[:-1])
        for law, run in rolled(case).runs.items():
            energies[law].append(10 ** (levels(run.contact_force[0], case.time_step) / 10))
            lost[law].append(1.0 - run.in_contact.mean())
    mean = {law: 10 * np.log10(np.mean(found, axis=0)) for law, found in energies.items()}
    for law, found in mean.items():
        print(
            f"| {load} N, {rms}, {first} to {first + 7} | {law} | {100 * np.mean(lost[law]):.1f} | "
            f"{away_of(found, mean['direct'])} |",
            flush=True,
        )


def main() -> None:
    """Print a table of all cases."""
    warnings.simplefilter("ignore")
    for name in FILTERED:
        spec = laws.spec_of(name)

        def build(materials, spec=spec):
            return replace(spec.build(materials), texture=materials.line, plane=None)

        laws.register(replace(spec, name=name + OLD, build=build, role=None, variants=()))
    print("| case | law | lost, % | dB rms | mean | worst | on the course: off, % | slope | mean |")
    print("|---|---|---:|---:|---:|---:|---:|---:|---:|")
    for name, case in cases():
        compare(name, case)
    for given in FLIGHT if "flight" in sys.argv[1:] else ():
        average(*given)


if __name__ == "__main__":
    main()
