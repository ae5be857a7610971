"""What moves sideways, by frequency: the lateral force that the vertical one makes, and its sound."""

import math
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from asperity.arguments import Array, Complex, NDArray
from asperity.contact.hertz import stick_stiffness
from asperity.radiation.track import SideOfRail, squared_lateral_mobility
from asperity.radiation.wheel import RadiatingWheel, fine_lines, line_means
from asperity.scenarios.scene import force_transfer
from asperity.scenes import compute, noise, schema
from asperity.scenes.observer import DECLARED, Observer
from asperity.schema import Values
from asperity.structures import lateral_rail, modal
from asperity.structures.track import Track
from asperity.structures.wheel_modes import WheelModes

PLACES = 12
"""Of the contact in a bay, over which squares are averaged."""

SOURCES = (
    "sideways: the rail as in D. Kostovasilis, D. J. Thompson and M. F. M. Hussein, J. Sound Vib. 2017, doi "
    "10.1016/j.jsv.2016.12.033, without warping unless its web bends; where the case gives no other, UIC 60 "
    "and a third of the pad stiffness as in the program rolland; friction of 0.3 chosen here.",
    "R. D. Mindlin, J. Appl. Mech. 16 (1949) 259 (contact in stick).",
)


@dataclass(frozen=True, eq=False)
class Sideways:
    """Forces and motion sideways, of what was rolled on one rail, on the lines of the spectra."""

    computed: compute.Computed

    @cached_property
    def track(self) -> lateral_rail.LateralTrack:
        """The track sideways, of equal bays."""
        keys = self.computed.case.track
        track = self.computed.track.nominal.regular
        return self.computed.case.sideways.model(track, keys.rail_foot_width)

    @cached_property
    def lines(self) -> Array:
        """Frequencies of the spectra (f,), Hz."""
        return self.computed.frequency[self.computed.shown]

    @cached_property
    def places(self) -> Array:
        """Of the contact in the bay (n,), m."""
        return self.track.track.sleeper_spacing * (np.arange(PLACES) + 0.5) / PLACES

    @cached_property
    def stiffness(self) -> tuple[float, float]:
        """Of the contact under the load, normal and in stick, N/m."""
        case = self.computed.case
        shape = self.computed.shape
        materials = case.rolling.material, case.rolled_over.material
        return self.computed.stiffness, stick_stiffness(shape.semi_axes, materials)

    def rail(self, frequency: Array | Complex, x: float | Array) -> Complex:
        """Receptances of the rail at the contact (2, 2, f), m/N, at a place along it, m, or some; Hz."""
        return self.track.answers(2.0 * np.pi * frequency, x, x, self.computed.case.contact_places[1])

    def wheel(self, frequency: Array | Complex) -> Complex:
        """Receptances of the wheel at the contact (2, 2, f), m/N; frequencies in Hz."""
        case = self.computed.case
        mass = case.rolling.contact_mass
        place, _ = case.contact_places
        return lateral_rail.wheel_receptances(self.computed.scene.modes, mass, frequency, place)

    # --- as the mean over each line of the spectra, with every resonance of the wheel resolved

    @cached_property
    def fine(self) -> tuple[Array, Array]:
        """Frequencies that resolve all resonances, and the edges of the lines, Hz."""
        modes: WheelModes | None = self.computed.scene.modes
        none = np.zeros(0)
        own = (none, none) if modes is None else (modes.natural_frequencies, modes.damping_ratios)
        return fine_lines(self.lines, *own)

    @cached_property
    def answers(self) -> Complex:
        """A at each place on them (2, 2, n, k), the rail's between its lines."""
        rails = self.rail(self.lines, self.places)
        both = self.wheel(self.fine[0])[:, :, None] + self.between(rails)
        return lateral_rail.at_springs(both, *self.stiffness)

    def between(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values on the lines (..., f) at the frequencies between them (..., k)."""
        return np.apply_along_axis(partial(np.interp, self.fine[0], self.lines), -1, values)

    @cached_property
    def shares(self) -> Complex:
        """Lateral over vertical force at each place (n, k)."""
        return lateral_rail.lateral_force(self.answers)

    @cached_property
    def spread(self) -> Array:
        """Mean square of the linear vertical force at each place over their mean (n, f)."""
        first = self.computed.scene.first
        normal, _ = self.stiffness
        square = np.abs(force_transfer(self.lines, first, self.track.track, normal, self.places)) ** 2
        return square / square.mean(axis=0)

    @cached_property
    def seen(self) -> tuple[Array, Array]:
        """Square of a compliance |α₀|² + |α_W|² (k,), and |α₀|² S_F + S_x (laws, contacts, f).

        The second over the first is S_F, and changes little within a line (`asperity.radiation.wheel`).
        """
        computed = self.computed
        middle = 0.5 * self.track.track.sleeper_spacing
        normal, _ = self.stiffness
        own = np.abs(1.0 / normal + self.track.track.receptance(self.lines, middle, middle))
        motion = computed.psd(computed.stacked("rolling_displacement"))
        force, moved = (each[..., computed.shown] for each in (computed.force_psd, motion))
        other = self.between(own) ** 2 + np.abs(self.wheel(self.fine[0])[0, 0]) ** 2
        return other, own**2 * force + moved

    @cached_property
    def seen_of_all(self) -> Array:
        """Its second part, the sum over all contacts (laws, f)."""
        return self.seen[1].sum(axis=1)

    def means(self, values: NDArray[Any]) -> NDArray[Any]:
        """Means over the lines (n, f) of values per square of the vertical force (n, k)."""
        return line_means(values / self.seen[0], *self.fine)

    @cached_property
    def squares(self) -> Array:
        """|T/F|² at each place (n, f), over |α₀|² + |α_W|²."""
        return self.means(np.abs(self.shares) ** 2)

    def rail_power(self) -> Array:
        """Sound power of the rail sideways (laws, f), W/Hz."""
        case = self.computed.case
        _, place = self.computed.case.contact_places
        forms = squared_lateral_mobility(self.track, self.lines, self.places, place)
        one = self.means(np.ones((1, len(self.fine[0]))))
        of_force = forms[:, 0, 0].real * one + forms[:, 1, 1].real * self.squares
        of_force += 2.0 * (forms[:, 0, 1] * self.means(self.shares)).real
        square = np.mean(self.spread * of_force, axis=0) * self.seen_of_all
        side = SideOfRail(self.track.height, case.track.rail_foot_width, case.track.rail_head_width)
        return side.power(self.lines, square)

    @cached_property
    def mode_power(self) -> Array:
        """Sound power of each mode of the wheels (2, laws, modes, f), W/Hz, the rigid motion first.

        Under both forces, and under the lateral one alone. None of a wheel whose modes are unknown. Rigid
        motion up and down is one nodal diameter around the tread, along the axle that of a rigid disc.
        """
        modes = self.computed.scene.modes
        case = self.computed.case
        fine = self.fine[0]
        laws, lines = self.seen_of_all.shape
        if modes is None:
            return np.zeros((2, laws, 0, lines))
        spread = self.between(self.spread) / PLACES
        share = np.sum(spread * self.shares, axis=0).real
        square = np.sum(spread * np.abs(self.shares) ** 2, axis=0)
        omega = 2.0 * np.pi * fine
        place, _ = case.contact_places
        radial, axial = (each[:, None] for each in modes.at(place))
        answers = modal.modal_answers(fine, modes.natural_frequencies, modes.damping_ratios).T
        rigid = 1.0 / (case.rolling.contact_mass * omega) ** 2
        numbers = np.concatenate([[1, 0], modes.nodal_diameters])
        disc = np.append([0.0, 1.0], modes.disc)
        tread = np.append([math.sqrt(0.5), 0.0], modes.tread)
        radiator = RadiatingWheel(case.rolling.radius, case.noise.wheel_width, numbers, disc, tread)

        def radiated(radially: float) -> Array:
            """Of this part of the vertical force together with the lateral one."""
            moved = radially * (radial**2 + 2.0 * radial * axial * share) + axial**2 * square
            velocity = np.vstack([radially * rigid, rigid * square, np.abs(omega * answers) ** 2 * moved])
            power = radiator.power(self.lines, self.means(velocity))
            each = np.vstack([power[:2].sum(axis=0, keepdims=True), power[2:]])
            return each * self.seen_of_all[:, None]

        return np.stack([radiated(1.0), radiated(0.0)])

    def on_all_lines(self, density: Array) -> Array:
        """A density on the lines (..., f) on all lines of the spectra, from zero."""
        whole = np.zeros((*density.shape[:-1], len(self.computed.frequency)))
        whole[..., self.computed.shown] = density
        return whole

    @property
    def power(self) -> noise.SidewaysPower:
        """Sound power of what was rolled on one rail, on all lines of the spectra."""
        both, lateral = self.mode_power
        parts = np.stack([self.rail_power(), both.sum(axis=1), lateral.sum(axis=1)], axis=1)
        return noise.SidewaysPower(self.on_all_lines(parts), self.on_all_lines(both), self.track)


def sideways_of(computed: compute.Computed) -> Sideways | None:
    """What moves sideways: nothing off a track, or where a contact in the middle bends no web of a wheel."""
    case = computed.case
    moves = "sideways" in case.inner and (any(case.contact_places) or case.rolling.is_drawn)
    return Sideways(computed) if moves and isinstance(computed.scene.over, Track) else None


def sideways_group(computed: compute.Computed) -> Values:
    """Lay out receptances and decay sideways, the lateral force of each law, and its grip.

    Nothing where nothing moves sideways.
    """
    found = computed.derived(sideways_of)
    if found is None:
        return {}
    case = computed.case
    band = computed.band
    contacts = len(computed.scene.offsets)
    limit = case.contact.friction * computed.shape.load
    step = found.lines[1] - found.lines[0]

    def levels(density: Array) -> Array:
        """Levels in bands (..., b), dB, of densities on the lines (..., f)."""
        return computed.levels(found.on_all_lines(density))

    density = np.mean(found.spread * found.squares, axis=0) * found.seen[1]  # of each contact, N²/Hz
    lateral = density.sum(axis=1) / contacts
    of_each = np.sqrt(density.sum(axis=-1) * step)
    with np.errstate(divide="ignore"):
        slips = np.vectorize(math.erfc)(limit / (math.sqrt(2.0) * of_each)).mean(axis=1)
    frequency = computed.swept
    rail = found.rail(frequency, 0.5 * found.track.track.sleeper_spacing)
    wheel = found.wheel(frequency)
    free = 1.0 / found.answers[0, 0]  # vertical force per height of a contact that is free sideways
    linear = np.mean(np.abs([lateral_rail.vertical_change(found.answers) * free, free]) ** 2, axis=1)
    coupling = np.subtract(*levels(line_means(linear, *found.fine)))
    return {
        schema.SIDEWAYS_LAW: list(computed.runs),
        schema.SIDEWAYS_FREQUENCY: frequency,
        schema.SIDEWAYS_BAND: band,
        schema.RAIL_LATERAL_RECEPTANCE: np.abs(rail[1, 1]),
        schema.RAIL_CROSS_RECEPTANCE: np.abs(rail[1, 0]),
        schema.WHEEL_LATERAL_RECEPTANCE: np.abs(wheel[1, 1]),
        schema.WHEEL_CROSS_RECEPTANCE: np.abs(wheel[1, 0]),
        schema.LATERAL_DECAY_RATE: found.track.decay_rate(frequency),
        schema.LATERAL_FORCE_PSD: lateral,
        schema.LATERAL_FORCE_LEVEL: levels(lateral),
        schema.VERTICAL_FORCE_CHANGE: coupling,
        schema.SLIP_SHARE: slips,
        schema.LATERAL_FORCE_SPREAD: np.sqrt(lateral.sum(axis=-1) * step),
        schema.SIDEWAYS_CONTACT: 1 + np.arange(contacts),
        schema.LATERAL_CONTACT_SPREAD: of_each,
        schema.CONTACT_PLACE: case.contact_places[0],
        schema.RAIL_CONTACT_PLACE: case.contact_places[1],
        schema.STICK_STIFFNESS: found.stiffness[1],
        schema.SLIP_FORCE: limit,
    }


OBSERVER = Observer(
    "sideways",
    DECLARED,
    lambda computed: computed.derived(sideways_group),
    needs=("track",),
    sources=SOURCES,
)
