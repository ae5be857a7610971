"""What a run will look at, in words; how finely its bodies are resolved; what its textures are judged by."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from xarray import DataTree

from asperity.arguments import Array
from asperity.case import beam, rolled_over
from asperity.case.scene import Case
from asperity.errors import ComputationError, warn_of_findings
from asperity.laws import Role, in_role
from asperity.scenarios import laws, preparing
from asperity.scenarios.refining import Setting, Way
from asperity.scenes import measured, noise, schema
from asperity.scenes.track import LOWEST, described_losses, findings_of_losses, loss_factor_error
from asperity.schema import Entry, spectra
from asperity.spectra import a_weighting, third_octave_bands
from asperity.structures.rail_poles import POLES
from asperity.structures.track import Track
from asperity.units import written

A_WEIGHTED = "A-weighted level"
ACCELERATION = "rms acceleration"
MEASURE_NAMES = (A_WEIGHTED, ACCELERATION)


def planned_rows(prepared: preparing.PreparedCase) -> list[tuple[str, str]]:
    """What else will be computed, in words: several contacts, a track, and its sound."""
    offsets, over = prepared.scene.offsets, prepared.scene.over
    found = []
    if len(offsets) > 1:
        places = f"{min(offsets):g} to {max(offsets):g} m ahead of the position"
        found.append(("contacts", f"{len(offsets)}, {places}"))
    return found + (_rows_of_track(prepared, over) if isinstance(over, Track) else [])


def _rows_of_track(prepared: preparing.PreparedCase, track: Track) -> list[tuple[str, str]]:
    """Characteristic numbers of the track, in words, and what is known of its sound."""
    case = prepared.case
    _, stiffness = laws.working_point(case.contact, prepared.shape, None)
    scene, highest = prepared.scene, case.numerics.highest_frequency
    losses = loss_factor_error(track, scene.first, stiffness, highest)
    bands = third_octave_bands(LOWEST, highest)[0]
    doubts = findings_of_losses(losses) + measured.findings_of_measured(case.track, track.nominal, bands)
    known = "rail, sleepers and wheel"
    if reason := noise.silent_wheel(case):
        known = f"rail and sleepers: {reason}"
    if in_role(Role.BARE, case.laws) is not None:
        known += (
            f"; by CNOSSOS-EU for {noise.track_label(case)} pads and a wheel of {noise.wheel_label(case)}"
        )
        doubts += noise.findings_of_labels(case)
    warn_of_findings(doubts)
    frequencies = f"critical speed {track.critical_speed:.4g} m/s"
    if not track.continuous:
        passing = f"sleeper passing {case.speed / track.sleeper_spacing:.4g} Hz"
        frequencies = f"pinned–pinned {track.pinned_pinned_frequency:.4g} Hz, {passing}, {frequencies}"
    points = ", ".join(f"{position:g} m" for position in scene.points)
    return [
        ("track", frequencies),
        *_rows_of_bays(track),
        *case.track.described_tables,
        *described_losses(losses),
        ("rail motion recorded at", points),
        ("sound power", f"of {known}"),
    ]


def _rows_of_bays(track: Track) -> Iterator[tuple[str, str]]:
    """How bays differ, in words; nothing where they do not."""
    if track.bays is None:
        return
    lengths, count = track.sleeper_spacing * track.bays.lengths, track.cell_bays
    parts = [f"{lengths.min():.3g} to {lengths.max():.3g} m long"]
    for name in ("pad", "ballast"):
        stiffness = 1e-6 * getattr(track, f"{name}_stiffness") * np.array(getattr(track.bays, name))
        if np.ptp(stiffness):
            parts.append(f"{name} {stiffness.min():.3g} to {stiffness.max():.3g} MN/m")
    yield "bays that differ", f"{count} in {track.period:.4g} m, then they repeat: {', '.join(parts)}"


def own_settings(case: Case) -> list[Setting]:
    """How finely what is rolled over is resolved: modes of a beam, or the kernel behind a track's poles."""
    over = case.rolled_over
    if isinstance(over, rolled_over.TrackKeys):
        if case.numerics.kernel != "poles":
            return [Setting("poles", (), "the rail is scattered from its kernel, without poles")]
        words = f"up to {case.numerics.poles or POLES} → the kernel that they are fitted to"
        scattered = Way(words, {"numerics.kernel": "scatter", "numerics.poles": None})
        return [Setting("poles", (scattered,))]
    if not isinstance(over, beam.BeamKeys):
        return []
    before = over.highest_mode(case.numerics.highest_frequency)
    words = f"up to {written(before, 'Hz', 'kHz')} → up to {written(2.0 * before, 'Hz', 'kHz')}"
    return [Setting("modes", (Way(words, {f"{case.over_name}.modes_up_to": 2.0 * before}),))]


@dataclass(frozen=True)
class Measure:
    """A quantity that textures of a kind of case are judged by."""

    meaning: str  # what it is the level of
    units: str  # of the level
    # its energy per Hz (f,) relative to the square of its reference, of a law in a result
    density: Callable[[DataTree, str], Array]
    beside: tuple[str, ...] = ()  # laws without which it is not known


def measures_of(case: Case) -> dict[str, Measure]:
    """What textures of a case are judged by, by name: sound where a track is rolled over, else motion."""
    if isinstance(case.rolled_over, rolled_over.TrackKeys):
        power = "sound power level of rolling, A-weighted"
        at_points = "acceleration level of the rail at the points passed by, energy mean"
        return {
            A_WEIGHTED: Measure(power, "dB(A) re 1 pW", a_weighted(_sound_power), ("linear",)),
            ACCELERATION: Measure(at_points, "dB re 1e-6 m/s²", _of_points),
        }
    if case.rolled_over.sensor_positions:
        meaning = f"acceleration level of the {case.over_name}, energy mean over its sensors"
        return {
            A_WEIGHTED: Measure(f"{meaning}, A-weighted", "dB(A) re 1e-6 m/s²", a_weighted(_of_sensors)),
            ACCELERATION: Measure(meaning, "dB re 1e-6 m/s²", _of_sensors),
        }
    meaning = "contact force level, energy mean over the contacts, A-weighted"
    return {A_WEIGHTED: Measure(meaning, "dB(A) re 1 N", a_weighted(_force))}


def _force(tree: DataTree, law: str) -> Array:
    return density_of(tree, spectra.FORCE_PSD, law)


def _of_sensors(tree: DataTree, law: str) -> Array:
    return density_of(tree, schema.ACCELERATION_PSD, law) / schema.ACCELERATION_REFERENCE**2


def _of_points(tree: DataTree, law: str) -> Array:
    velocity = density_of(tree, schema.POINT_VELOCITY_PSD, law)
    return velocity * (2.0 * np.pi * line_frequencies(tree) / schema.ACCELERATION_REFERENCE) ** 2


def _sound_power(tree: DataTree, law: str) -> Array:
    """Energy of a band, shared out over its lines as the force is: it has no finer spectrum."""
    held = tree[schema.SOUND_POWER_LEVEL.group].to_dataset()
    if schema.SOUND_POWER_LEVEL.name not in held:
        what = "the sound power of rolling is not known"
        raise ComputationError(what, "a rough rail, and bands between 50 Hz and 10 kHz")
    power = held[schema.SOUND_POWER_LEVEL.name].sel(law=law, source="total").values
    centre, frequency = held[schema.NOISE_BAND.name].values, line_frequencies(tree)
    force = _force(tree, law)
    step = frequency[1] - frequency[0]
    density = np.zeros_like(force)
    for middle, level in zip(centre, power, strict=True):
        inside = np.abs(np.log10(frequency / middle)) <= 0.05
        if inside.any() and force[inside].sum() > 0.0 and np.isfinite(level):
            density[inside] = 10.0 ** (level / 10.0) * force[inside] / (force[inside].sum() * step)
    return density


def line_frequencies(tree: DataTree) -> Array:
    """Frequencies of the spectra of a result (f,), Hz."""
    return np.asarray(tree[spectra.FREQUENCY.path].values)


def density_of(tree: DataTree, entry: Entry, law: str) -> Array:
    """PSD of a law over frequency (f,), mean over the places at which it is known."""
    found = tree[entry.group].to_dataset()[entry.name].sel(law=law)
    places = [dim for dim in found.dims if dim != spectra.FREQUENCY.name]
    return np.asarray(found.mean(places).values)


def a_weighted(density: Callable[[DataTree, str], Array]) -> Callable[..., Array]:
    """Weight a density as the ear does."""
    return lambda tree, law: 10.0 ** (a_weighting(line_frequencies(tree)) / 10.0) * density(tree, law)
