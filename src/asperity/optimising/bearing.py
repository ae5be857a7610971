"""The roughest waves of a ball bearing that keep its velocities in the bands of ISO 15242 under limits."""

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from asperity.arguments import Array
from asperity.case import any_case, form
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.diagnostics import ISO_BANDS, band_velocities
from asperity.errors import ComputationError, InputError, PhysicsWarning
from asperity.optimising.allocation import (
    AIMED_BELOW,
    FREE,
    MOST_ROUNDS,
    RELAXATION,
    SETTLED_LEVEL,
    SMALLEST_SHARE,
)
from asperity.optimising.kinds import Optimisation
from asperity.optimising.several_limits import cheapest
from asperity.parameters import DURATION, ListOf, Number, Quantity, key, optional
from asperity.progress import Progress
from asperity.running import run
from asperity.scenarios.prepared_bearing import ON, prepare_bearing
from asperity.scenes.computed_bearing import compute_bearing
from asperity.schema import bearing
from asperity.spectra import HALF_BAND, third_octave_bands
from asperity.store import Store, made
from asperity.surfaces.raceway import AroundTexture
from asperity.threads import one_thread_in_linear_algebra
from asperity.written_numbers import count_of, in_a_row, rounded, signed

if TYPE_CHECKING:
    from asperity.scenes.report import Result

FORMAT = 1
"""Raise it when what is kept of a trial no longer means what it meant."""
PARTS = tuple(part for part in ON if part != "fault")
"""Sections of a case whose waves and roughness may be changed."""
JUDGED = tuple(zip(("low_band", "medium_band", "high_band"), ISO_BANDS, strict=True))
"""Keys of the limits, and the bands of ISO 15242 that they limit, Hz."""
STEP = 6.0
"""By which levels are raised from one trial to the next at most, dB."""
CORRECTIONS = 3
"""How often limits are lowered at most by what they are missed by when all of the duration is rolled."""
STRANGE = 3.0
"""Level over a limit, dB, from which a trial says that levels were raised too far: they are no more then."""
MADE = (1e-11, 1e-4)
"""Rms heights, m, between which parts are made, unless they have others."""
_LIMIT = Quantity("m/s", above=0)
_LIMITS = "1 nm/s to 1 m/s: bearings are quieter"
_COUNT = Number(at_least=1, whole=True)
_ORDERS = "1 to 100000: others are shorter than contacts"


class BearingAim(form.Section):
    """What waves and roughness of a ball bearing shall be."""

    low_band: float | None = optional(
        _LIMIT, "50 um/s", "largest radial velocity, rms, in 50 to 300 Hz", "any", _LIMITS
    )
    medium_band: float | None = optional(_LIMIT, "30 um/s", "the same in 300 to 1800 Hz", "any", _LIMITS)
    high_band: float | None = optional(_LIMIT, "30 um/s", "the same in 1.8 to 10 kHz", "any", _LIMITS)
    law: str = key(any_case.LAW, "areal", "law of the contact force that is rolled while searching")
    verify: str = key(any_case.LAW, "table", "law with which the bearing is rolled before and after")
    record: float = key(
        DURATION,
        "0.2 s",
        "time that a trial records, as there are many; the bearing is rolled for all its duration before and "
        "after",
        "1 ms to 1 h: records lie between",
    )
    fewest_waves: int = key(_COUNT, 2, "fewest waves per turn that are changed", _ORDERS)
    most_waves: int | None = optional(
        _COUNT, 100, "most waves per turn that are changed", "the most there are", _ORDERS
    )
    reach: float = key(
        Quantity("dB", above=0),
        "20 dB",
        "how far levels may go from those of the case, up and down",
        "0.01 dB to 100 dB: five powers of ten are another surface",
    )
    price: tuple[float, ...] = key(
        ListOf(Number(at_least=0)),
        (1.0,),
        "price of lowering one third octave, or the roughness, by 1 dB, which raising it saves: one for all "
        "parts, or one each for inner raceway, outer raceway and balls",
    )

    def problems(self) -> Iterator[InputError]:
        """A limit, prices of the parts, waves in order."""
        if not any(getattr(self, name) for name, _ in JUDGED):
            yield InputError("medium_band", "no limit of any band", "a velocity for one of them at least")
        if len(self.price) not in (1, len(PARTS)):
            yield InputError("price", count_of(len(self.price), "value"), f"one, or {len(PARTS)}")
        elif not any(self.price):
            yield InputError("price", "only zeros", "a price that tells which roughness is worth more")
        if self.most_waves is not None and self.most_waves < self.fewest_waves:
            yield InputError("most_waves", self.most_waves, f"at least fewest_waves, {self.fewest_waves}")

    @property
    def limits(self) -> Array:
        """Limits of the bands (3,), m/s; infinite where there is none."""
        return np.array([getattr(self, name) or np.inf for name, _ in JUDGED])


@dataclass(frozen=True)
class PartBand:
    """A third octave of waves per turn of one part, or its roughness: what is made higher or lower as one."""

    part: str  # section of the case
    orders: tuple[int, ...]  # waves per turn; none of the roughness
    rms: float  # m, as the case has it

    @property
    def name(self) -> str:
        """It in words."""
        waves = "roughness"
        if self.orders:
            first = min(self.orders)
            last = max(self.orders)
            waves = f"{first} waves" if first == last else f"{first} to {last} waves"
        return f"{ON[self.part].removeprefix('the ')}, {waves}"


def amplitudes_of(texture: AroundTexture) -> dict[int, float]:
    """Amplitudes, m, of all waves of a texture that the case describes, by waves per turn.

    Those of its spectrum and those that are listed have the same phases, so that they add.
    """
    found: dict[int, float] = {}
    if texture.waviness:
        for order in range(texture.first_order, texture.last_order + 1):
            found[order] = texture.waviness * (order / texture.first_order) ** -texture.fall
    for order, amplitude in zip(texture.waves, texture.amplitudes, strict=True):
        found[order] = found.get(order, 0.0) + amplitude
    return {order: amplitude for order, amplitude in sorted(found.items()) if amplitude > 0.0}


def part_bands(case: BearingUnderLoad, aim: BearingAim) -> list[PartBand]:
    """All that may be changed: third octaves of the waves of each part, the longest first, and roughness."""
    found = list[PartBand]()
    last = np.inf if aim.most_waves is None else aim.most_waves
    for part in PARTS:
        texture = getattr(case, part).texture()
        waves = amplitudes_of(texture)
        changed = [order for order in waves if aim.fewest_waves <= order <= last]
        if changed:
            for centre in third_octave_bands(changed[0] / HALF_BAND, changed[-1] * HALF_BAND)[0]:
                inside = tuple(n for n in changed if centre / HALF_BAND <= n < centre * HALF_BAND)
                if inside:
                    rms = float(np.sqrt(0.5 * sum(waves[order] ** 2 for order in inside)))
                    found.append(PartBand(part, inside, rms))
        if texture.roughness:
            found.append(PartBand(part, (), texture.roughness))
    if not found:
        received = f"none of {aim.fewest_waves} waves per turn or more on any part, and no roughness"
        allowed = "a case with waviness, waves or roughness on a raceway or on the balls"
        raise InputError("bands that may be changed", received, allowed)
    return found


def with_energies(case: BearingUnderLoad, bands: list[PartBand], energies: Array) -> BearingUnderLoad:
    """The case with so many times the mean square of each band; all else stays as it is."""
    changes = dict[str, dict[str, object]]()
    for part in dict.fromkeys(band.part for band in bands):
        waves = amplitudes_of(getattr(case, part).texture())
        keys = dict[str, object](waviness=None, first_order=None, last_order=None, fall=None)
        for band, energy in zip(bands, energies.tolist(), strict=True):
            if band.part == part and not band.orders:
                keys["roughness"] = band.rms * energy**0.5 or None
            elif band.part == part:
                waves |= {order: waves[order] * energy**0.5 for order in band.orders}
        there = {order: amplitude for order, amplitude in waves.items() if amplitude > 0.0}
        changes[part] = keys | {"waves": list(there) or None, "amplitudes": list(there.values()) or None}
    return case.with_(**changes)


@dataclass(frozen=True, eq=False)
class BearingTrial:
    """Waves and roughness that were rolled: their energies over those of the case, and what is heard."""

    energies: Array  # (b,)
    velocities: Array  # (3,), rms, m/s, in the bands of ISO 15242; NaN where the sampling does not reach


@dataclass(frozen=True, eq=False)
class OptimisedBearing:
    """A bearing whose waves and roughness were optimised.

    Attributes
    ----------
    aim : BearingAim
        What they should be.
    bands : list of PartBand
        What was changed, and what the case had.
    changes : ndarray (b,)
        By how much the level of each is changed, dB.
    alone : ndarray (b, 3)
        Velocity in the bands of ISO 15242 that each makes by itself as the case has it, m/s.
    floor : ndarray (3,)
        Velocities with none of them: of balls that pass under the load, and of all that is not changed.
    trials : tuple of BearingTrial
        Those that the search went through; that of the case first, the one found last.
    came_to_rest : bool
        Whether the search ended by itself.
    case : BearingUnderLoad
        The case with what was found.
    result_before, result_after : Result
        Both, rolled with ``aim.verify`` and ``aim.law`` for all the duration of the case.
    """

    aim: BearingAim
    bands: list[PartBand]
    changes: Array
    alone: Array
    floor: Array
    trials: tuple[BearingTrial, ...]
    came_to_rest: bool
    case: BearingUnderLoad
    result_before: "Result"
    result_after: "Result"

    @property
    def price(self) -> float:
        """Price of the change: of all lowering, less what raising saves."""
        return float(-_prices(self.aim, self.bands) @ self.changes)

    def velocities(self, *, after: bool, law: str) -> Array:
        """Velocities (3,), m/s, rms over the sensors, of one of the two results by a law."""
        tree = self.result_after if after else self.result_before
        found = tree[bearing.BAND_VELOCITY.group].to_dataset()[bearing.BAND_VELOCITY.name].sel(law=law)
        return np.sqrt(np.mean(found.values**2, axis=0))

    @property
    def missed(self) -> dict[str, Array]:
        """By how much the run after is over the limits (3,), dB, by law."""
        return {law: _over(self.velocities(after=True, law=law), self.aim.limits) for law in self.laws}

    @property
    def settled(self) -> bool:
        """Whether the search ended by itself, and the run after keeps all limits by each law."""
        return self.came_to_rest and not any(each.any() for each in self.missed.values())

    @property
    def laws(self) -> tuple[str, ...]:
        """Laws of both results: that of the check, then that of the search."""
        return tuple(dict.fromkeys((self.aim.verify, self.aim.law)))

    @property
    def sentence(self) -> str:
        """What came of it, for people."""
        words = []
        for number, (name, (low, high)) in enumerate(JUDGED):
            limit = getattr(self.aim, name)
            if limit is None:
                continue
            told = [
                f"by {law} {_micro(self.velocities(after=False, law=law)[number])} to "
                f"{_micro(self.velocities(after=True, law=law)[number])}"
                for law in self.laws
            ]
            over = [
                f"{rounded(each[number], 2)} dB by {law}" for law, each in self.missed.items() if each[number]
            ]
            words.append(
                f"{low:g} to {high:g} Hz, limit {_micro(limit)} µm/s: {', '.join(told)} µm/s "
                f"({_micro(self.floor[number])} without what was changed)"
                f"{f': missed by {in_a_row(over)}' if over else ''}."
            )
        raised = int(np.count_nonzero(self.changes > SETTLED_LEVEL))
        lowered = int(np.count_nonzero(self.changes < -SETTLED_LEVEL))
        words.append(
            f"Price {rounded(self.price)}: {lowered} of {count_of(len(self.bands), 'band')} lowered, "
            f"{raised} raised, by {signed(self.changes.min())} to {signed(self.changes.max())} dB. "
            f"Trials recorded {rounded(min(self.aim.record, self.case.duration))} s each."
        )
        if not self.settled:
            words.append("The search did not settle: the best that was met is shown.")
        return " ".join(words)


def _over(velocities: Array, limits: Array) -> Array:
    """Levels over limits (3,), dB; 0 where they are kept, or there is none."""
    with np.errstate(divide="ignore"):
        over = 20.0 * np.log10(velocities / limits)
    return np.where(over > 0.0, over, 0.0)


def _micro(velocity: float) -> str:
    return rounded(1e6 * float(velocity))


def _prices(aim: BearingAim, bands: list[PartBand]) -> Array:
    each = dict(zip(PARTS, np.broadcast_to(np.array(aim.price), len(PARTS)).tolist(), strict=True))
    return np.array([each[band.part] for band in bands])


_HEAD = """\
# The roughest waves of a ball bearing that keep limits. Run it with: asperity optimise FILE
# The case: its path, from the folder of this file, or a section [case] with its keys.

case = "case.toml"

"""


def bearing_aim_template() -> str:
    """A commented case and aim."""
    return _HEAD + any_case.commented(BearingAim, {"medium_band": '"30 um/s"'})


def optimised_bearing(case: BearingUnderLoad, aim: BearingAim, progress: Progress) -> OptimisedBearing:
    """Find the roughest waves and roughness of a bearing, by their price, that keep limits of its velocities.

    Each band of each part is rolled alone. What it adds is the acceleration less that of the bearing without
    any of them, sample by sample: balls that pass under a load shake it, too, in the same lines, so that
    energies do not add. How they sum up is then corrected by trials of all together, and limits that are
    missed where all of the duration is rolled, by another law too, are lowered by that and sought again.
    """
    bands = part_bands(case, aim)
    limits = aim.limits
    numbers = itertools.count(1)

    def roll(energies: Array, words: str) -> Array:
        number = next(numbers)
        progress(number, max(number + 1, len(bands) + 3), f"bearing {number}: {words}")
        return _accelerations(with_energies(case, bands, energies), aim, progress)

    none = np.zeros(len(bands))
    without = roll(none, "without waves")
    floor = _velocities(case, without)
    _refuse_reached(limits, floor)
    each = [roll(alone, band.name) for band, alone in zip(bands, np.eye(len(bands)), strict=True)]
    alone = np.array([_velocities(case, acceleration - without) for acceleration in each])
    laws = tuple(dict.fromkeys((aim.verify, aim.law)))

    def verified(of: BearingUnderLoad) -> "Result":
        return run(of.with_(laws=laws), progress, brief=True)  # what each part makes is known by the search

    def sought(kept: Array) -> OptimisedBearing:
        trials, rests = _search(
            lambda energies: _velocities(case, roll(energies, "all together")),
            alone, floor, bands, aim, kept,
        )  # fmt: skip
        energies = trials[-1].energies
        changes = 10.0 * np.log10(energies)
        found = with_energies(case, bands, energies)
        return OptimisedBearing(
            aim, bands, changes, alone, floor, tuple(trials), rests, found, before, verified(found)
        )

    before = verified(case)
    return _within(sought, aim.limits)


def _within(sought: Callable[[Array], OptimisedBearing], limits: Array) -> OptimisedBearing:
    """What is found for limits (3,), m/s, lowered by what they are missed by, until they are kept; else that
    which misses them least."""
    found = [sought(limits)]
    lowered = np.zeros(len(limits))
    while (missed := _most_missed(found[-1])).any() and len(found) <= CORRECTIONS:
        lowered = lowered + np.where(missed > 0.0, missed + AIMED_BELOW, 0.0)
        try:
            found.append(sought(limits * 10.0 ** (-lowered / 20.0)))
        except ComputationError:  # nothing keeps lower ones
            break
    return min(reversed(found), key=lambda each: float(_most_missed(each).max()))


def _most_missed(found: OptimisedBearing) -> Array:
    """By how much the run after is over the limits (3,), dB, by the law that misses them most."""
    return np.max(list(found.missed.values()), axis=0)


def _refuse_reached(limits: Array, floor: Array) -> None:
    """Refuse limits that nothing which is changed can keep, or that no record tells of."""
    for (name, (low, high)), limit, velocity in zip(JUDGED, limits, floor, strict=True):
        band = f"in {low:g} to {high:g} Hz"
        if np.isfinite(limit) and np.isnan(velocity):
            remedy = "Raise sampling_rate of the case, or leave the limit out."
            raise InputError(name, f"a limit {band}", "bands that the sampling reaches", remedy)
        if velocity >= limit:
            received = f"{_micro(limit)} um/s {band}"
            allowed = f"more than {_micro(velocity)} um/s, which the bearing has without what is changed"
            remedy = "Lower the load, or remove faults, or raise the preload: balls that pass shake it."
            raise InputError(name, received, allowed, remedy)


def _ends(bands: list[PartBand], aim: BearingAim) -> tuple[Array, Array]:
    """Least and largest energies of the bands, over those of the case: as levels and parts reach."""
    reach = 10.0 ** (aim.reach / 10.0)
    rms = np.array([band.rms for band in bands])
    smoothest, roughest = ((each / rms) ** 2 for each in MADE)
    return np.clip(smoothest, 1.0 / reach, 1.0), np.clip(roughest, 1.0, reach)


def _search(
    roll: Callable[[Array], Array],
    alone: Array,
    floor: Array,
    bands: list[PartBand],
    aim: BearingAim,
    limits: Array,
) -> tuple[list[BearingTrial], bool]:
    """Search the cheapest energies that keep limits (3,), m/s; trials, the best last, and whether the search
    ended by itself."""
    price = _prices(aim, bands)
    price = np.maximum(price, FREE * price.max())
    lowest, highest = _ends(bands, aim)
    limited = np.isfinite(limits)
    weights = np.where(limited, np.nan_to_num(alone), 0.0).T ** 2
    still = np.where(limited, np.nan_to_num(floor), 0.0) ** 2
    aimed = limits * 10.0 ** (-AIMED_BELOW / 20.0)
    left = np.maximum(aimed**2, 0.5 * (limits**2 + still)) - still  # where a limit is just above the floor

    def heard(energies: Array) -> BearingTrial:
        return BearingTrial(energies, roll(energies))

    def followed(trial: BearingTrial) -> Array:
        """How many times what bands add alone they add together, by limit."""
        added = np.nan_to_num(trial.velocities) ** 2 - still
        told = weights @ trial.energies
        share = np.divide(added, told, out=np.ones_like(told), where=told > 0.0)
        return np.maximum(share, SMALLEST_SHARE)

    def excess(trial: BearingTrial) -> Array:
        """Levels over the limits (3,), dB; none where nothing is limited."""
        with np.errstate(divide="ignore"):
            return np.where(limited, 20.0 * np.log10(trial.velocities / limits), -np.inf)

    last = heard(np.ones(len(bands)))
    trials = [last]
    scale = followed(last)
    for _ in range(MOST_ROUNDS):
        within = np.clip(highest, lowest, last.energies * 10.0 ** (STEP / 10.0))
        trial = heard(cheapest(scale[:, None] * weights, left, price, lowest, within))
        trials.append(trial)
        over = excess(trial)[limited]
        moved = np.abs(10.0 * np.log10(trial.energies / last.energies)).max()
        held_back = (trial.energies > within * 10.0 ** (-SETTLED_LEVEL / 10.0)) & (within < highest)
        at_limits = np.abs(over).max() <= SETTLED_LEVEL and not held_back.any()
        if over.max() <= 0.0 and (at_limits or moved < SETTLED_LEVEL):
            return trials, True
        found = followed(trial)
        if over.max() > STRANGE:  # so high up waves do not add as they did: balls leave the rings
            highest = np.minimum(highest, last.energies)
        else:
            last = trial
            scale = scale ** (1.0 - RELAXATION) * found**RELAXATION

    def rank(trial: BearingTrial) -> tuple[float, float]:
        """By how much a limit is missed, then the price."""
        return max(float(excess(trial).max()), 0.0), float(-price @ np.log10(trial.energies))

    return [*trials, min(trials[1:], key=rank)], False


def _accelerations(case: BearingUnderLoad, aim: BearingAim, progress: Progress) -> Array:
    """Accelerations of all sensors (sensors, n), m/s², of a short record by the law of the search.

    It is kept by all that it depends on: interrupted, the same search goes on where it was.
    """
    short = case.with_(laws=[aim.law], duration=min(aim.record, case.duration))

    def rolled() -> dict[str, Array]:
        # of what is found it is warned
        with PhysicsWarning.ignored(), one_thread_in_linear_algebra():
            (found,) = compute_bearing(prepare_bearing(short), progress).runs.values()
        return {"acceleration": found.acceleration}

    return made(Store(), form.case_key("bearing-waves", FORMAT, short, aim.law), rolled)["acceleration"]


def _velocities(case: BearingUnderLoad, acceleration: Array) -> Array:
    """Velocities in the bands of ISO 15242 (3,), m/s, rms over the sensors."""
    judged = [band_velocities(each, case.sampling_rate, quantity="acceleration") for each in acceleration]
    return np.sqrt(np.mean(np.square(judged), axis=0))


OF_BEARINGS = Optimisation(BearingAim, optimised_bearing, "asperity.cli.optimising_bearing.told_bearing")
