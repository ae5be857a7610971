"""What is looked at where a track is rolled over: texture, linear reference, the rail and its losses."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from asperity import spectra
from asperity.arguments import Array
from asperity.case.scene import Case
from asperity.errors import Finding, Grade, LossFactorWarning, warn_of_findings
from asperity.reduction.texture import along_path
from asperity.reference.railways import iso_3095_decay_rate
from asperity.reporting import data
from asperity.scenarios.laws import working_point
from asperity.scenarios.records import spectrum_levels
from asperity.scenarios.scene import PreparedCase, Receptance, Scene, mean_square_transfer
from asperity.scenarios.textures import self_affine_keys
from asperity.scenes import beside_track, cnossos_power, compute, measured, noise, schema
from asperity.scenes.observer import DECLARED, Observer
from asperity.scenes.over_frequency import held_values
from asperity.scenes.sideways import sideways_group, sideways_of
from asperity.schema import Values, group
from asperity.schema import spectra as spectra_schema
from asperity.speeds import SpeedCourse, at_fastest, slowest
from asperity.structures.causal_track import causal_track
from asperity.structures.track import Track, decay_rate, decay_rate_en15461
from asperity.surfaces.synthesis import SelfAffine, line_levels
from asperity.written_numbers import between, rounded


def track_spectra(computed: compute.Computed) -> Values:
    """Lay out texture, linear reference, motion of the rail, and sound power, of what rolls over a track."""
    shown = computed.shown
    reference, texture = linear_reference(computed)
    velocity = computed.psd(computed.points[1])
    *_, values = computed.derived(held_values)
    side = computed.derived(sideways_of)
    return {
        schema.TEXTURE_PSD: texture[shown],
        schema.LINEAR_REFERENCE_PSD: reference[shown],
        schema.LINEAR_REFERENCE_LEVEL: computed.levels(reference),
        schema.SPECTRA_POINT: computed.case.point_positions,
        schema.POINT_VELOCITY_PSD: velocity[..., shown],
        schema.POINT_VELOCITY_LEVEL: computed.levels(velocity, schema.VELOCITY_REFERENCE),
        **_roughness(computed),
        **cnossos_power.standard_power(computed),
        **noise.radiation(computed, values, None if side is None else side.power),
        **tones(computed),
    }


PLACES = 12
"""In a bay, over which linear forces are averaged; of one contact in half of it, its own mirror image."""
MOST_PLACES = 120
"""In a cell of bays that differ."""


def linear_reference(computed: compute.Computed) -> tuple[Array, Array]:
    """One-sided PSDs (f,) of the force of the linear contact, N²/Hz, and of the texture passed, m²/Hz.

    In the frequency domain, of several contacts their mean; the track is the nominal one, with constant loss
    factors. Without motion: at each position the structures answer as if the wheels stood there. Valid while
    the speed is far below that of waves in the rail, and away from the pinned-pinned frequency, whose peak
    motion splits and lowers; without the tones of the sleepers.
    """
    case = computed.case
    textures = computed.textures
    scene = computed.scene
    track = computed.track
    position = computed.first.positions[0]
    frequency = computed.frequency

    def passed(line: Array) -> Array:
        """PSD of a line at the contact."""
        at = along_path("texture", line[None, :], textures.start, case.contact.spacing, position)[:, 0]
        return computed.psd(at)

    texture = passed(textures.followed)
    force = np.zeros_like(texture)
    above = frequency > 0.0
    lines = frequency[above]
    stiffness = computed.stiffness
    if len(scene.offsets) == 1:
        square = mean_square_transfer(lines, scene.first, track, stiffness, track.places(PLACES))
        force[above] = square * texture[above]
        return force, texture
    turning = textures.parts.get("wheel", np.zeros_like(textures.line))
    path = passed(textures.followed - turning)
    own = passed(turning)
    count = min(PLACES * track.cell_bays, MOST_PLACES)
    places = track.period * (np.arange(count) + 0.5) / count
    along, each = _coupled(scene, stiffness, case.speed, places, lines)
    force[above] = along * path[above] + each * own[above]
    return force, texture


SPEEDS = 9
"""Speeds of a course over which the linear reference of several contacts is a mean."""
MOST_COUPLED = 8
"""Contacts that the linear reference takes as coupled: the work grows with their square."""


def _coupled(scene: Scene, stiffness: float, speed: float, places: Array, frequency: Array) -> Array:
    """Mean squares of the force of several linear contacts per height, mean of them (2, f), (N/m)².

    Of what all pass one after the other, and of what each has by itself. With T_ij = F_i/z_j that of a
    contact i is |Σ T_ij exp(iω d_j/v)|² S_path + Σ |T_ij|² S_own, sums over j, d_j ahead of the first, as a
    mean over the places (p,) of the run, m. Frequencies (f,), Hz, above zero; speed, m/s. Of the contacts
    those `MOST_COUPLED` that are numbered first.
    """
    count = min(len(scene.offsets), MOST_COUPLED)
    ahead = np.array(scene.offsets[:count]) - scene.offsets[0]
    speeds = np.linspace(slowest(speed), speed, SPEEDS) if slowest(speed) < speed else np.array([speed])
    delays = [np.exp(2j * np.pi * np.outer(ahead, frequency) / each) for each in speeds]
    squares = np.zeros((2, len(frequency)))
    for place in places:
        transfer = scene.coupled_transfer(stiffness, float(place), frequency, count)
        for delay in delays:
            squares[0] += np.mean(np.abs(np.sum(transfer * delay, axis=1)) ** 2, axis=0) / len(delays)
        squares[1] += np.mean(np.sum(np.abs(transfer) ** 2, axis=1), axis=0)
    return squares / len(places)


def _roughness(computed: compute.Computed) -> Values:
    """Band levels of rail and wheel over wavelength, without flat and joint."""
    textures = computed.textures
    spacing = computed.case.contact.spacing
    bands = computed.line_levels
    wavelength = bands["combined"][0]
    averaged = spectra.averaging_time(len(textures.line), spacing)
    entry = schema.SURFACE_BAND_LENGTH_PRODUCT
    product = spectra.band_product(1.0 / wavelength, averaged)
    stated = stated_levels(computed.case, list(bands), wavelength)
    said: Values = {schema.STATED_ROUGHNESS_LEVEL: stated} if np.isfinite(stated).any() else {}
    return said | {
        schema.PART: list(bands),
        schema.SURFACE_BAND: wavelength,
        entry: entry.variable(product, least=spectra.LEAST_PRODUCT),
        schema.ROUGHNESS_LEVEL: np.stack([level for _, level in bands.values()]),
    }


def stated_levels(case: Any, parts: Sequence[str], wavelength: Array) -> Array:
    """Levels that spectra of a case state of parts of the texture (n, b), dB re 1 µm.

    At wavelengths (b,), m, by name or from a table, with the level added, or of a self-affine texture. NaN
    where none does: of what was measured, in the bands of a corrugation on top, and of the combined texture
    where it is not stated of all that is rough.
    """
    surface = case.surface
    rolling = case.rolling
    found = {"rail": _stated(surface.spectrum, surface.level, wavelength)}
    if surface.rms is not None and surface.spectrum is None and surface.line is None:
        drawn = line_levels(SelfAffine(**self_affine_keys(surface)), wavelength)
        found["rail"] = np.where(np.isfinite(drawn), drawn, np.nan)
    found["wheel"] = _stated(rolling.roughness, rolling.roughness_level, wavelength)
    if surface.corrugation is not None:
        half = 2.0 ** (0.5 * (surface.corrugation_bandwidth or 0.0)) * spectra.HALF_BAND
        apart = np.maximum(
            wavelength / surface.corrugation_wavelength, surface.corrugation_wavelength / wavelength
        )
        found["rail"][apart < half] = np.nan
    smooth_wheel = rolling.roughness is None and rolling.line is None
    rough = ["rail"] if smooth_wheel else ["rail", "wheel"]
    with np.errstate(invalid="ignore"):
        found["combined"] = spectra.energy_sum([found[name] for name in rough], axis=0)
    return np.stack([found.get(part, np.full(len(wavelength), np.nan)) for part in parts])


def _stated(spectrum: Any, level: float, wavelength: Array) -> Array:
    """Levels of a spectrum at wavelengths (b,), where it has these bands."""
    if spectrum is None:
        return np.full(len(wavelength), np.nan)
    own, levels, _ = spectrum_levels(spectrum)
    return spectra.in_bands(wavelength, own, levels) + level


def tones(computed: compute.Computed) -> Values:
    """Frequencies that speed, track and wheel have of themselves; of spread supports that of the wheel."""
    case = computed.case
    pinned = computed.track.pinned_pinned_frequency
    turns: Values = {schema.WHEEL_REVOLUTION_FREQUENCY: case.speed / (2.0 * math.pi * case.rolling.radius)}
    if computed.track.continuous:
        return turns
    half = 0.5 * case.speed / computed.track.sleeper_spacing
    return turns | {
        schema.SLEEPER_PASSING_FREQUENCY: 2.0 * half,
        schema.PINNED_PINNED_LOW: pinned - half,
        schema.PINNED_PINNED_HIGH: pinned + half,
    }


OF_TRACK = (
    schema.NAME,
    schema.SLEEPER_SPACING,
    schema.PINNED_PINNED_FREQUENCY,
    schema.CUT_ON_FREQUENCY,
    schema.ANTIRESONANCE_FREQUENCY,
    schema.CRITICAL_SPEED,
)
"""What a track says of itself under these names."""


def track_group(computed: compute.Computed) -> Values:
    """Lay out what the wheel rolls on: receptances, decay rates, loss factors and numbers.

    None of it depends on what has rolled.
    """
    track = computed.track
    in_time = computed.rail.kernel.track
    load = computed.shape.load
    frequency = computed.swept
    half = float(track.mid_spans[0])
    midspan, support = track.receptance(frequency, [half, 0.0], [half, 0.0])
    return {
        schema.TRACK_FREQUENCY: frequency,
        schema.RECEPTANCE_MIDSPAN: np.abs(midspan),
        schema.RECEPTANCE_MIDSPAN_PHASE: np.angle(midspan),
        schema.RECEPTANCE_SUPPORT: np.abs(support),
        schema.RECEPTANCE_SUPPORT_PHASE: np.angle(support),
        schema.WHEEL_RECEPTANCE: np.abs(computed.scene.first(frequency)),
        schema.CONTACT_RECEPTANCE: np.full(len(frequency), 1.0 / computed.stiffness),
        schema.DECAY_RATE: decay_rate(track, frequency),
        schema.DECAY_RATE_EN15461: decay_rate_en15461(track, frequency),
        schema.DECAY_RATE_LIMIT: iso_3095_decay_rate(frequency),
        **facts(track),
        schema.STATIC_DEFLECTION: track.static_deflection(load, half),
        schema.STATIC_DEFLECTION_IN_TIME: in_time.static_deflection(load, half),
        **computed.derived(losses_of),
        **_bays(track, frequency),
    }


def facts(track: Track) -> Values:
    """What a track says of itself, but for frequencies that it does not have."""
    values = {fact: getattr(track, fact.name) for fact in OF_TRACK}
    return {fact: value for fact, value in values.items() if isinstance(value, str) or np.isfinite(value)}


def _bays(track: Track, frequency: Array) -> Values:
    """Lay out how bays differ, and their mid-spans beside one of equal bays; nothing where they do not."""
    if not track.bays:
        return {}
    half = 0.5 * track.sleeper_spacing
    spans = track.mid_spans
    squares = np.abs(track.receptance(frequency, spans, spans)) ** 2
    return {
        schema.BAY: 1 + np.arange(track.cell_bays),
        schema.BAY_LENGTH: track.sleeper_spacing * track.bays.lengths,
        schema.BAY_PAD_STIFFNESS: track.pad_stiffness * np.array(track.bays.pad),
        schema.BAY_BALLAST_STIFFNESS: track.ballast_stiffness * np.array(track.bays.ballast),
        schema.RECEPTANCE_ALL_BAYS: np.sqrt(np.mean(squares, axis=0)),
        schema.RECEPTANCE_EQUAL_BAYS: np.abs(track.regular.receptance(frequency, half, half)),
    }


# --- what stands for the loss factors of a track in time, and how far the contact force is off for it

LOWEST = 5.0
"""Frequency in the first one-third octave, Hz."""
LINES, POSITIONS = 64, 12
"""Frequencies in a band, and places in half a bay."""
DOUBTFUL = 0.75
"""Error of a band, dB, from which on it is warned of."""
LEAST_SHOWN = 0.05
"""Errors below this, dB, are not listed."""


def loss_factor_error(track: Track, wheel: Receptance, stiffness: float, highest: float) -> Values:
    """Level of the linear contact force on the causal track that stands in time for one, over that on itself.

    Nothing for a causal one. Tangent stiffness of the contact at the static load, N/m; bands from 5 Hz to
    that of `highest`, Hz. In each band of mean squares over a bay, the nominal one, and over the band, for a
    texture that is white in it.
    """
    if track.is_causal:
        return {}
    bands, low, high = spectra.third_octave_bands(LOWEST, highest)
    steps = (np.arange(LINES) + 0.5) / LINES
    frequency = (low[:, None] + (high - low)[:, None] * steps).ravel()

    def level(rail: Track) -> Array:
        square = mean_square_transfer(frequency, wheel, rail, stiffness, rail.places(POSITIONS))
        return 10.0 * np.log10(square.reshape(-1, LINES).mean(axis=-1))

    error = level(causal_track(track.regular)) - level(track.regular)
    return {schema.TRACK_BAND: bands, schema.LOSS_FACTOR_FORCE_ERROR: error}


def losses_of(computed: compute.Computed) -> Values:
    """The same of what was rolled over, up to the highest frequency of its case."""
    highest = computed.case.numerics.highest_frequency
    return loss_factor_error(computed.track, computed.scene.first, computed.stiffness, highest)


def findings_of_losses(losses: Values) -> list[Finding]:
    """Hold the error of the contact force to its limit; nothing where the track has no loss factors."""
    if not losses:
        return []
    bands, force = losses.values()
    worst = int(np.argmax(np.abs(force)))
    level = force[worst]
    frequency = bands[worst]
    meaning = "Nothing that answers after a force only has one loss factor at all frequencies, or any table"
    if off := [spectra.nominal_frequency(bands[i]) for i in np.flatnonzero(np.abs(force) > DOUBTFUL)]:
        meaning += f": read the one-third octaves of {', '.join(off)} with their error"
    return [
        Finding(
            "error of the contact force for constant loss factors, at most",
            f"{data.signed(level)} dB ({spectra.nominal_frequency(frequency)})",
            f"up to {DOUBTFUL:g} dB",
            Grade.WARNING if off else None,
            f"{meaning}.",
            "Give dampings, which are exact, or smaller loss factors; is a table that of one pad?",
            category=LossFactorWarning,
        )
    ]


def described_losses(losses: Values) -> Iterator[tuple[str, str]]:
    """Say how far the force is off in each band: name and value; nothing where there are no loss factors."""
    if not losses:
        return
    off = [
        f"{spectra.nominal_frequency(band)} {data.signed(level)}"
        for band, level in zip(*losses.values(), strict=True)
        if abs(level) >= LEAST_SHOWN
    ]
    shown = [*off, f"{'else ' if off else ''}below {LEAST_SHOWN:g}"]
    yield "loss factors in time", f"error of the contact force, dB: {', '.join(shown)}"


def pass_by_of(computed: compute.Computed) -> Values:
    """Lay out levels beside the track; note where they lack the wheel's part."""
    noise.warn_of_silence(computed.case)
    over_bands: Values = {spectra_schema.LAW: list(computed.runs), spectra_schema.BAND: computed.band}
    in_bands = group(over_bands | computed.derived(track_spectra))
    return beside_track.pass_by_group(computed.case, in_bands, computed.derived(sideways_group))


def asks_for_pass_by(case: Case) -> bool:
    """Whether levels beside the track are computed of a case: not where its speed changes."""
    return not isinstance(case.speed, SpeedCourse)


def findings_of_noise(computed: compute.Computed) -> list[Finding]:
    """Hold what CNOSSOS-EU knows, and what was measured, to the track and the wheel of the case."""
    case = computed.case
    labelled = schema.SOUND_POWER_LEVEL_A in computed.derived(track_spectra)
    of_labels = cnossos_power.findings_of_labels(case) if labelled else []
    return of_labels + measured.findings_of_measured(case.track, computed.track.nominal, computed.band)


TRACK = Observer(
    "track",
    DECLARED,
    track_group,
    needs=("track",),
    findings=lambda computed: findings_of_losses(computed.derived(losses_of)),
    numerics=lambda computed: described_losses(computed.derived(losses_of)),
    sources=lambda computed: computed.track.sources,
)
"""The track by itself."""
RAIL = Observer(
    "rail",
    DECLARED,
    lambda computed: computed.derived(track_spectra),
    needs=("track",),
    findings=findings_of_noise,
    sources=lambda computed: (*cnossos_power.cited(computed.case), *beside_track.sources_of(computed.case)),
)
"""Motion and sound power of what rolls over a track, over frequency."""
PASS_BY = Observer(
    "pass_by",
    DECLARED,
    pass_by_of,
    needs=("track",),
    asked_of=lambda computed: asks_for_pass_by(computed.case),
)
"""What is heard beside the track."""


def doubt_sound(prepared: PreparedCase) -> None:
    """Warn of a wheel whose sound is not computed, as the run will."""
    if isinstance(prepared.scene.over, Track) and asks_for_pass_by(prepared.case):
        noise.warn_of_silence(prepared.case)


def planned_track(prepared: PreparedCase) -> list[tuple[str, str]]:
    """Characteristic numbers of a track that is rolled over, in words, and what is known of its sound."""
    case = prepared.case
    track = prepared.scene.over
    if not isinstance(track, Track):
        return []
    _, stiffness = working_point(case.contact, prepared.shape, None)
    scene = prepared.scene
    highest = case.numerics.highest_frequency
    losses = loss_factor_error(track, scene.first, stiffness, highest)
    bands = spectra.third_octave_bands(LOWEST, highest)[0]
    doubts = findings_of_losses(losses) + measured.findings_of_measured(case.track, track.nominal, bands)
    known = "rail, sleepers and wheel"
    if reason := noise.silent_wheel(case):
        known = f"rail and sleepers: {reason}"
    if np.ptp(prepared.textures.line) and asks_for_pass_by(case):
        pads = cnossos_power.track_label(case)
        diameter = cnossos_power.wheel_label(case)
        known += f"; by CNOSSOS-EU for {pads} pads and a wheel of {diameter}"
        doubts += cnossos_power.findings_of_labels(case)
    warn_of_findings(doubts)
    frequencies = f"critical speed {rounded(track.critical_speed, 4)} m/s"
    if not track.continuous:
        passing = (
            f"sleeper passing {rounded(case.speed / track.sleeper_spacing, 4)} Hz{at_fastest(case.speed)}"
        )
        frequencies = (
            f"pinned–pinned {rounded(track.pinned_pinned_frequency, 4)} Hz, {passing}, {frequencies}"
        )
    points = ", ".join(f"{position:g} m" for position in case.point_positions)
    return [
        ("track", frequencies),
        *_rows_of_bays(track),
        *case.track.described_tables,
        *described_losses(losses),
        ("rail motion recorded at", points),
        ("sound power", f"of {known}"),
        *_left_out(case.speed),
    ]


def _left_out(speed: float) -> list[tuple[str, str]]:
    """What is not computed of a speed that changes, in words."""
    if not isinstance(speed, SpeedCourse):
        return []
    return [("not of a speed that changes", "sound power by CNOSSOS-EU, and levels beside the track")]


def _rows_of_bays(track: Track) -> Iterator[tuple[str, str]]:
    """How bays differ, in words; nothing where they do not."""
    if track.bays is None:
        return
    lengths = track.sleeper_spacing * track.bays.lengths
    count = track.cell_bays
    parts = [f"{between(rounded(lengths.min()), rounded(lengths.max()))} m long"]
    for name in ("pad", "ballast"):
        stiffness = 1e-6 * getattr(track, f"{name}_stiffness") * np.array(getattr(track.bays, name))
        if np.ptp(stiffness):
            parts.append(f"{name} {between(rounded(stiffness.min()), rounded(stiffness.max()))} MN/m")
    yield "bays that differ", f"{count} in {rounded(track.period, 4)} m, then they repeat: {', '.join(parts)}"
