"""What is looked at where a track is rolled over: texture, linear reference, the rail and its losses."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import xarray

from asperity import spectra
from asperity.arguments import Array, ArrayLike
from asperity.errors import Finding, Grade, LossFactorWarning
from asperity.reduction.texture import along_path
from asperity.reference.tracks import iso_3095_decay_rate
from asperity.scenarios.scene import AtContact, Scene, linear_force_psd
from asperity.scenes import compute, noise, schema, validity
from asperity.schema import Entry, Values
from asperity.structures import rail_poles, stiffness_table, track_parameters, track_power
from asperity.structures.causal_track import causal_track
from asperity.structures.track import Track, decay_rate, decay_rate_en15461
from asperity.surfaces.bands import band_levels_of
from asperity.surfaces.heightmap import Profile


def track_spectra(computed: compute.Computed) -> Values:
    """Lay out texture, linear reference, motion of the rail, and sound power, of what rolls over a track."""
    shown, case = computed.shown, computed.case
    reference, texture = linear_reference(computed)
    velocity = computed.psd(computed.points[1])
    laid_out: Values = {
        schema.TEXTURE_PSD: texture[shown],
        schema.LINEAR_REFERENCE_PSD: reference[shown],
        schema.LINEAR_REFERENCE_LEVEL: computed.levels(reference),
        schema.SPECTRA_POINT: computed.scene.points,
        schema.POINT_VELOCITY_PSD: velocity[..., shown],
        schema.POINT_VELOCITY_LEVEL: computed.levels(velocity, schema.VELOCITY_REFERENCE),
    }
    laid_out |= _roughness(computed) | noise.noise(computed) | noise.radiation(computed)
    if schema.NOISE_BAND in laid_out:
        time = spectra.averaging_time(len(computed.first.time), case.time_step, segment=computed.segment)
        product = product_of_bands(schema.NOISE_BAND_TIME_PRODUCT, laid_out[schema.NOISE_BAND], time)
        laid_out[schema.NOISE_BAND_TIME_PRODUCT] = product
    return laid_out


def product_of_bands(entry: Entry, centres: Array, time: float) -> xarray.Variable:
    """Lay out the product B T of bands, from which one sees which levels say little.

    Centres (b,), Hz or cycles per metre; averaging time, s, or length, m. The least product of a level that
    says something is in its attributes.
    """
    return entry.variable(spectra.band_product(centres, time), least=spectra.LEAST_PRODUCT)


PLACES = 12
"""Of several contacts in a bay, over which their linear forces are averaged."""
MOST_PLACES = 120
"""In a cell of bays that differ."""


def linear_reference(computed: compute.Computed) -> tuple[Array, Array]:
    """One-sided PSDs (f,) of the force of the linear contact, N²/Hz, and of the texture passed, m²/Hz.

    In the frequency domain, of several contacts their mean; the track is the nominal one, with constant loss
    factors.
    """
    case, textures, scene, track = computed.case, computed.textures, computed.scene, computed.track
    position, frequency = computed.first.positions[0], computed.frequency

    def passed(line: Array) -> Array:
        """PSD of a line at the contact."""
        at = along_path("texture", line[None, :], textures.start, case.contact.spacing, position)[:, 0]
        return computed.psd(at)

    texture = passed(textures.followed)
    force, above = np.zeros_like(texture), frequency > 0.0
    lines, speed, stiffness = frequency[above], case.speed, computed.stiffness
    if len(scene.offsets) == 1:
        seen = texture[above] * speed
        force[above] = linear_force_psd(lines, seen, speed, scene.first, track, stiffness)
        return force, texture
    turning = textures.parts.get("wheel", np.zeros_like(textures.line))
    path, own = passed(textures.followed - turning), passed(turning)
    count = min(PLACES * track.cell_bays, MOST_PLACES)
    places = track.period * (np.arange(count) + 0.5) / count
    force[above] = coupled_force_psd(lines, path[above], own[above], speed, scene, stiffness, places)
    return force, texture


MOST_COUPLED = 8
"""Contacts that the linear reference takes as coupled: the work grows with their square."""


def coupled_force_psd(
    frequency: Array,
    path_psd: Array,
    own_psd: Array,
    speed: float,
    scene: Scene,
    stiffness: float,
    places: ArrayLike,
) -> Array:
    """One-sided PSD of the force of several linear contacts, mean of them, (f,), N²/Hz.

    The contacts pass the same path one after the other, and each has a texture of its own: of these are the
    PSDs (f,), m²/Hz. With T_ij = F_i/z_j that of a contact i is |Σ T_ij exp(iω d_j/v)|² S_path
    + Σ |T_ij|² S_own, sums over j, d_j ahead of the first, as a mean over the places (p,) of the run, m.
    Frequencies (f,), Hz, above zero; speed, m/s. As `linear_force_psd` without motion; of the contacts those
    `MOST_COUPLED` that are numbered first.
    """
    count = min(len(scene.offsets), MOST_COUPLED)
    ahead = np.array(scene.offsets[:count]) - scene.offsets[0]
    delay = np.exp(2j * np.pi * np.outer(ahead, frequency) / speed)
    density, at = np.zeros(len(frequency)), np.atleast_1d(np.asarray(places, dtype=float))
    for place in at:
        transfer = scene.coupled_transfer(stiffness, float(place), frequency, count)
        density += np.mean(np.abs(np.sum(transfer * delay, axis=1)) ** 2, axis=0) * path_psd
        density += np.mean(np.sum(np.abs(transfer) ** 2, axis=1), axis=0) * own_psd
    return np.asarray(density / at.size)


def _roughness(computed: compute.Computed) -> Values:
    """Band levels of rail and wheel over wavelength, without flat and joint."""
    textures, spacing = computed.textures, computed.case.contact.spacing
    lines = {**textures.parts, "combined": textures.line}
    bands = {name: band_levels_of(Profile(line, spacing)) for name, line in lines.items()}
    wavelength = bands["combined"][0]
    averaged = spectra.averaging_time(len(textures.line), spacing)
    product = product_of_bands(schema.SURFACE_BAND_LENGTH_PRODUCT, 1.0 / wavelength, averaged)
    return {
        schema.PART: list(bands),
        schema.SURFACE_BAND: wavelength,
        schema.SURFACE_BAND_LENGTH_PRODUCT: product,
        schema.ROUGHNESS_LEVEL: np.stack([level for _, level in bands.values()]),
    }


def tones(computed: compute.Computed) -> Values:
    """Frequencies that speed, track and wheel have of themselves; of spread supports that of the wheel."""
    case, pinned = computed.case, computed.track.pinned_pinned_frequency
    turns: Values = {schema.WHEEL_REVOLUTION_FREQUENCY: case.speed / (2.0 * math.pi * case.rolling.radius)}
    if computed.track.continuous:
        return turns
    half = 0.5 * case.speed / computed.track.sleeper_spacing
    return turns | {
        schema.SLEEPER_PASSING_FREQUENCY: 2.0 * half,
        schema.PINNED_PINNED_LOW: pinned - half,
        schema.PINNED_PINNED_HIGH: pinned + half,
    }


LOWEST_FREQUENCY, FREQUENCIES = 20.0, 600
OF_TRACK = (
    schema.NAME,
    schema.SLEEPER_SPACING,
    schema.PINNED_PINNED_FREQUENCY,
    schema.CUT_ON_FREQUENCY,
    schema.ANTIRESONANCE_FREQUENCY,
    schema.CRITICAL_SPEED,
)
"""What a track says of itself under these names."""
KERNEL_STARTS = 6
KERNEL_LAG = 0.25
"""Longest lag of the moving kernel that is kept in a result, s."""


def track_group(computed: compute.Computed, losses: "LossFactorError") -> Values:
    """Lay out what the wheel rolls on: receptances, decay rates, moving kernel, loss factors and numbers.

    None of it depends on what has rolled.
    """
    track, rail, load = computed.track, computed.rail, computed.shape.load
    kernel = rail.kernel
    frequency = np.geomspace(LOWEST_FREQUENCY, computed.case.numerics.highest_frequency, FREQUENCIES)
    half = float(track.mid_spans[0])
    midspan, support = track.receptance(frequency, [half, 0.0], [half, 0.0])
    positions, taps = kernel.weights.shape
    rows = np.arange(0, positions, max(1, positions // KERNEL_STARTS))
    kept = slice(0, min(taps, round(KERNEL_LAG / kernel.time_step)))
    laid_out: Values = {
        schema.TRACK_FREQUENCY: frequency,
        schema.RECEPTANCE_MIDSPAN: np.abs(midspan),
        schema.RECEPTANCE_MIDSPAN_PHASE: np.angle(midspan),
        schema.RECEPTANCE_SUPPORT: np.abs(support),
        schema.RECEPTANCE_SUPPORT_PHASE: np.angle(support),
        schema.WHEEL_RECEPTANCE: np.abs(computed.scene.first.receptance(frequency)),
        schema.CONTACT_RECEPTANCE: np.full(FREQUENCIES, 1.0 / computed.stiffness),
        schema.DECAY_RATE: decay_rate(track, frequency),
        schema.DECAY_RATE_EN15461: decay_rate_en15461(track, frequency),
        schema.DECAY_RATE_LIMIT: iso_3095_decay_rate(frequency),
        schema.START_POSITION: rows * track.period / positions,
        schema.LAG: kernel.lag[kept],
        schema.MOVING_KERNEL: kernel.weights[rows, kept] / kernel.time_step,
        **facts(track),
        schema.STATIC_DEFLECTION: track.static_deflection(load, half),
        schema.STATIC_DEFLECTION_IN_TIME: kernel.track.static_deflection(load, half),
        schema.KERNEL_METHOD: "scatter",
        **relaxed(losses),
        **power_shares(track, frequency),
        **_bays(track, frequency),
    }
    if isinstance(rail.direct, rail_poles.RailPoles):
        laid_out |= {schema.KERNEL_METHOD: "poles", schema.KERNEL_FIT_ERROR: rail.direct.fit_error}
        laid_out |= {schema.KERNEL_POLES: rail.direct.count}
    return laid_out


def facts(track: Track) -> Values:
    """What a track says of itself, but for frequencies that it does not have."""
    values = {fact: getattr(track, fact.name) for fact in OF_TRACK}
    return {fact: value for fact, value in values.items() if isinstance(value, str) or np.isfinite(value)}


def power_shares(track: Track, frequency: Array) -> Values:
    """Lay out what share each part of a track dissipates of the power of a force at mid-span.

    Of bays that differ, the nominal one.
    """
    parts = track_power.dissipated_power(track.regular, frequency, 0.5 * track.sleeper_spacing)
    powers = np.array(list(parts.values()))
    return {schema.POWER_PART: list(parts), schema.POWER_SHARE: powers / powers.sum(axis=0)}


def _bays(track: Track, frequency: Array) -> Values:
    """Lay out how bays differ, and their mid-spans beside one of equal bays; nothing where they do not."""
    if not track.bays:
        return {}
    half, spans = 0.5 * track.sleeper_spacing, track.mid_spans
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
PARTS = ("rail", *track_parameters.LAYERS)


@dataclass(frozen=True, eq=False)
class LossFactorError:
    """What the causal track changes of a track with constant loss factors, for a linear contact at rest."""

    track: Track  # with constant loss factors
    bands: Array  # (b,), centres of one-third octaves, Hz
    force: Array  # (b,), level of the contact force over that with constant loss factors, dB
    rail: Array  # (b,), level of the rail's displacement under a given force over that, dB

    @property
    def worst(self) -> int:
        """Index of the band whose force is farthest off."""
        return int(np.argmax(np.abs(self.force)))


def loss_factor_error(track: Track, wheel: AtContact, stiffness: float, highest: float) -> LossFactorError:
    """Compare a track with the causal one that stands for it in time; the error of a causal one is zero.

    Tangent stiffness of the contact at the static load, N/m; bands from 5 Hz to that of `highest`, Hz. In
    each band of mean squares over a bay, the nominal one, and over the band, for a texture that is white in
    it.
    """
    bands, low, high = spectra.third_octave_bands(LOWEST, highest)
    steps = (np.arange(LINES) + 0.5) / LINES
    frequency = (low[:, None] + (high - low)[:, None] * steps).ravel()
    places = track.regular.places(POSITIONS)

    def levels(rail: Track) -> Array:
        moved = rail.receptance(frequency, places, places)
        force = 1.0 / (wheel.receptance(frequency) + 1.0 / stiffness + moved)  # as `force_transfer`
        squares = np.mean(np.abs(np.stack([force, moved])) ** 2, axis=1)
        return 10.0 * np.log10(squares.reshape(2, -1, LINES).mean(axis=-1))

    force, rail = levels(causal_track(track.regular)) - levels(track.regular)
    return LossFactorError(track, bands, force, rail)


def error_of_losses(computed: compute.Computed) -> LossFactorError:
    """Error of the contact force in bands, for the contact stiffness at the load."""
    return loss_factor_error(
        computed.track, computed.scene.first, computed.stiffness, computed.case.numerics.highest_frequency
    )


def findings_of_losses(error: LossFactorError) -> list[Finding]:
    """Hold the error of the contact force to its limit; nothing where the track has no loss factors."""
    if error.track.is_causal:
        return []
    level, frequency = error.force[error.worst], error.bands[error.worst]
    table = error.track.pad_table
    factors = {part: getattr(error.track, f"{part}_loss_factor") or 0.0 for part in PARTS}
    layer = max(factors, key=factors.__getitem__)
    if table is not None and (largest := float(table_of(table, error.bands)[1].max())) > factors[layer]:
        layer, factors = "pad", {"pad": largest}
    words = layer.replace("_", " ")
    meaning = "Nothing that answers after a force only has the loss factor "
    meaning += f"{factors[layer]:g} of the {words} at all frequencies"
    remedy = "Give the rail a smaller one."
    if layer == "pad" and table is not None:
        meaning = "The springs and dampers that stand in time for the table of the pad miss it"
        remedy = (
            "Losses need a stiffness that rises with frequency, as steeply: is the table that of one pad?"
        )
    elif layer != "rail":
        stiffness = getattr(error.track, f"{layer}_stiffness")
        damping = 1e-3 * stiffness * factors[layer] / (2.0 * np.pi * frequency)
        exact = f"{damping:.3g} kN s/m dissipate as much at {frequency:.3g} Hz"
        remedy = f"Give {layer}_damping, which is exact: {exact}."
    if off := [
        spectra.nominal_frequency(error.bands[i]) for i in np.flatnonzero(np.abs(error.force) > DOUBTFUL)
    ]:
        meaning += f": read the one-third octaves of {', '.join(off)} with their error"
    return [
        Finding(
            "error of the contact force for constant loss factors, at most",
            f"{validity.signed_level(level)} dB ({spectra.nominal_frequency(frequency)})",
            f"up to {DOUBTFUL:g} dB",
            Grade.WARNING if off else None,
            f"{meaning}.",
            remedy,
            category=LossFactorWarning,
        )
    ]


def relaxed(error: LossFactorError) -> Values:
    """Lay out the stiffnesses that relax, and the errors in bands; nothing without loss factors."""
    relaxations = causal_track(error.track).relaxations
    parts = {name: getattr(relaxations, name, None) for name in PARTS}
    layers = {name: part.at(2.0 * np.pi * error.bands) for name, part in parts.items() if part is not None}
    if not layers:
        return {}
    stiffness = np.array(list(layers.values()))
    measured: Values = {}
    if error.track.pad_table is not None:
        entries = schema.MEASURED_STIFFNESS, schema.MEASURED_LOSS_FACTOR
        measured = dict(zip(entries, table_of(error.track.pad_table, error.bands), strict=True))
    return measured | {
        schema.TRACK_BAND: error.bands,
        schema.LAYER: list(layers),
        schema.LOSS_FACTOR_FORCE_ERROR: error.force,
        schema.LOSS_FACTOR_RAIL_ERROR: error.rail,
        schema.LOSS_FACTOR: [getattr(error.track, f"{name}_loss_factor") or np.nan for name in layers],
        schema.RELAXED_STIFFNESS: stiffness.real,
        schema.RELAXED_LOSS_FACTOR: stiffness.imag / stiffness.real,
    }


def table_of(table: stiffness_table.StiffnessTable, bands: Array) -> tuple[Array, Array]:
    """Stiffness over the nominal one and loss factor of a table (b,) in the middle of bands, Hz."""
    measured = table.at(2.0 * np.pi * bands)
    return measured.real, measured.imag / measured.real


def described_losses(error: LossFactorError, load: float) -> Iterator[tuple[str, str]]:
    """Say how far the force is off in each band, and how much softer the track is at rest under a load, N.

    Names and values; nothing where the track has no loss factors.
    """
    nominal, track = error.track, causal_track(error.track)
    if nominal.is_causal or track.relaxations is None:
        return
    off = [
        f"{spectra.nominal_frequency(band)} {validity.signed_level(level)}"
        for band, level in zip(error.bands, error.force, strict=True)
        if abs(level) >= LEAST_SHOWN
    ]
    shown = [*off, f"{'else ' if off else ''}below {LEAST_SHOWN:g}"]
    yield "loss factors in time", f"error of the contact force, dB: {', '.join(shown)}"
    own = track.relaxations
    relaxing = {"pads" if name == "pad" else name: part for name, part in vars(own).items() if part}
    shares = ", ".join(f"{name.replace('_', ' ')} {part.static:.2f}" for name, part in relaxing.items())
    half = float(track.mid_spans[0])
    rest, was = (1e3 * each.static_deflection(load, half) for each in (track, nominal))
    down = f"the load at mid-span rests {rest:.3g} mm down, nominally {was:.3g} mm"
    yield "stiffness at rest", f"of the nominal one: {shares}; {down}"
