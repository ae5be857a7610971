"""What several bodies roll over: the modes of a structure, a rigid plane, or a rail."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from asperity.errors import InputError, LargeDeflectionWarning
from asperity.kernels.rail import Channels
from asperity.rolling.path import Path
from asperity.rolling.stability import Limit
from asperity.rolling.steps import PLACES, alternating_of_modes, most_compliance, resolved_step
from asperity.structures.beam import Beam, SupportedBeam
from asperity.structures.modal import STATIC, Modal
from asperity.structures.moving_kernel import MovingKernel
from asperity.structures.rail_poles import CELLS, RailBetween, RailPoles, over_the_bay

Array = NDArray[np.float64]


LARGEST_DEFLECTION = 0.02
"""Share of the length up to which a beam may be displaced: slopes are then below about 0.06."""


class Under(Protocol):
    """What is rolled over, as several contacts need it."""

    @property
    def modes(self) -> tuple[Array, Array]:
        """Natural angular frequencies, rad/s, and damping ratios (m,) of its modes, if it has any."""
        ...

    def refuse(self, paths: Sequence[Path]) -> None:
        """Refuse paths of contacts that leave it, or that it was not made for."""
        ...

    def at_sensors(self, places: Array) -> Array:
        """Mode shapes at places, m, (k, m), kg^(−1/2)."""
        ...

    def shapes(self, positions: Array) -> tuple[Array, Array]:
        """Mode shapes, kg^(−1/2), and their slopes, per metre, at positions (k,), m: both (k, m)."""
        ...

    def channels(self, paths: Sequence[Path]) -> Channels:
        """Those of a rail; none of a structure that is its modes."""
        ...

    def static_compliance(self, paths: Sequence[Path]) -> Array:
        """Displacement of each contact at the start for a constant unit force at each (n, n), m/N."""
        ...

    def most_compliance(self, paths: Sequence[Path]) -> float:
        """Largest static compliance of a contact on its path, m/N; infinite if nothing holds it."""
        ...

    def alternating(self, paths: Sequence[Path]) -> tuple[float, float]:
        """Least alternating compliance of all contacts at once, and that of what throws bodies apart, m/N."""
        ...

    def judge(self, displaced: Array) -> None:
        """Warn of displacements under the contacts (n, steps), m, that it is not made for."""
        ...

    def limits(self, resonance: float, stiffness: float, path: Path) -> Iterator[Limit]:
        """What the time step must resolve, by the contacts' highest resonance, Hz, and stiffness, N/m."""
        ...

    @property
    def steps_asked(self) -> float:
        """Time steps that a period of the highest frequency asked for takes."""
        ...

    @property
    def memory(self) -> int:
        """Time steps that a rail remembers; none of a structure that is its modes."""
        ...


def no_channels(contacts: int) -> Channels:
    """Those of what is no rail."""
    none = np.zeros(0, dtype=np.int64)
    return Channels(
        source=none,
        receiver=none,
        table=none,
        first=np.zeros(contacts + 1, dtype=np.int64),
        place=np.zeros(contacts),
        stride=0.0,
        decay=np.zeros((0, 0)),
        residue=np.zeros((0, 1, 0)),
        now=np.zeros((0, 1)),
        scattered=np.zeros((0, 1, 1)),
        scatters=np.zeros(0, dtype=bool),
    )


class OnModes:
    """A structure given by its modes, or a plane that does not move."""

    steps_asked, memory = 10.0, 0

    def __init__(self, over: Modal | None) -> None:
        self.over = over

    @property
    def modes(self) -> tuple[Array, Array]:
        """Natural angular frequencies and damping ratios."""
        if self.over is None:
            return np.zeros(0), np.zeros(0)
        return 2.0 * np.pi * self.over.natural_frequencies, self.over.damping_ratios

    def refuse(self, paths: Sequence[Path]) -> None:
        """Refuse contacts that leave the structure."""
        if self.over is None:
            return
        low, high = self.over.extent
        margin = 1e-9 * (high - low)
        for k, path in enumerate(paths):
            first, end = float(path.positions[0]), float(path.positions[-1])
            if not (first >= low - margin and end <= high + margin):
                raise InputError(
                    f"path of contact {k + 1} (m)",
                    f"{first:.6g} to {end:.6g}",
                    f"{low:.6g} to {high:.6g}, on the structure",
                    "Choose start, duration, run-in and positions so that all contacts stay on it.",
                )

    def at_sensors(self, places: Array) -> Array:
        """Mode shapes there."""
        if places.size and self.over is None:
            raise InputError("sensors", f"{places.size} on a rigid plane", "none: it does not move")
        return self.shapes(places)[0]

    def shapes(self, positions: Array) -> tuple[Array, Array]:
        """Mode shapes and slopes."""
        if self.over is None or not positions.size:
            none = np.zeros((positions.size, len(self.modes[0])))
            return none, none
        return self.over.shapes(positions)

    def channels(self, paths: Sequence[Path]) -> Channels:
        """None."""
        return no_channels(len(paths))

    def static_compliance(self, paths: Sequence[Path]) -> Array:
        """Of the modes that have a stiffness."""
        (shapes, _), natural = self.shapes(_starts(paths)), self.modes[0]
        held = natural > 0.0
        return np.asarray((shapes[:, held] / natural[held] ** 2) @ shapes[:, held].T)

    def most_compliance(self, paths: Sequence[Path]) -> float:
        """Of all modes, at some places."""
        return 0.0 if self.over is None else most_compliance(self.over, paths)

    def alternating(self, paths: Sequence[Path]) -> tuple[float, float]:
        """The same for both, at some places on the path."""
        if self.over is None:
            return 0.0, 0.0
        each = alternating_of_modes(resolved_step(*self.modes, paths[0].time_step))
        places = slice(None, None, max(1, len(paths[0].positions) // PLACES))
        shapes = np.stack([self.shapes(path.positions[places])[0] for path in paths], axis=1)
        least = float(np.linalg.eigvalsh((shapes * each) @ shapes.transpose(0, 2, 1)).min())
        return least, least

    def judge(self, displaced: Array) -> None:
        """Compare the deflection of a beam with what beam theory allows."""
        if not isinstance(self.over, Beam | SupportedBeam):
            return
        deflection = float(np.abs(displaced).max())
        share = deflection / self.over.length
        if share > LARGEST_DEFLECTION:
            warnings.warn(
                f"the beam is displaced by up to {deflection:.3g} m under the contact, "
                f"{100 * share:.2g} % of its length: beam theory needs small slopes, as up to "
                f"{100 * LARGEST_DEFLECTION:.0f} %; check load, section, length and support of the beam",
                LargeDeflectionWarning,
                stacklevel=4,
            )

    def limits(self, resonance: float, stiffness: float, path: Path) -> Iterator[Limit]:
        """Contacts and modes."""
        yield "the contact resonance", resonance, 10.0
        if self.over is not None:
            natural = self.over.natural_frequencies
            highest = float(natural[natural < STATIC].max(initial=0.0))  # others are meant to be static
            yield "the highest mode of the structure", highest, 4.0


class OnRail:
    """A rail, by poles or scattered, between contacts at fixed distances."""

    modes = np.zeros(0), np.zeros(0)
    steps_asked = 5.0

    def __init__(self, rail: RailBetween) -> None:
        self.rail, self.kernel = rail, rail.kernel
        self.memory = self.kernel.weights.shape[1]

    def refuse(self, paths: Sequence[Path]) -> None:
        """Refuse another speed or time step than that of its kernels."""
        path, kernel = paths[0], self.kernel
        given, made = (path.speed, path.time_step), (kernel.speed, kernel.time_step)
        if not np.allclose(given, made, rtol=1e-9, atol=0.0):
            received = f"{given[0]:.6g} m/s in steps of {given[1]:.6g} s"
            allowed = f"{made[0]:.6g} m/s and {made[1]:.6g} s, for which the rail's kernel was computed"
            raise InputError("path", received, allowed, "Compute the moving kernel of this path.")

    def at_sensors(self, places: Array) -> Array:
        """None: a rail is known under the contacts."""
        if places.size:
            allowed = "none: a rail is known under the contacts alone"
            raise InputError("sensors", f"{places.size} on a rail", allowed)
        return np.zeros((0, 0))

    def shapes(self, positions: Array) -> tuple[Array, Array]:
        """Without modes."""
        return np.zeros((positions.size, 0)), np.zeros((positions.size, 0))

    def _tables(
        self, paths: Sequence[Path]
    ) -> tuple[list[tuple[int, int, int]], list[RailPoles | MovingKernel]]:
        """Source, receiver and table of each channel, and the tables; the first is the direct one."""
        tables: list[RailPoles | MovingKernel] = [self.rail.direct]
        pairs, starts = [], _starts(paths)
        for source, here in enumerate(starts):
            for receiver, there in enumerate(starts):
                found = self.rail.direct if source == receiver else self.rail.between(there - here)
                if found is not None:
                    if not any(found is table for table in tables):
                        tables.append(found)
                    index = next(i for i, table in enumerate(tables) if table is found)
                    pairs.append((source, receiver, index))
        return pairs, tables

    def channels(self, paths: Sequence[Path]) -> Channels:
        """Between all contacts within reach."""
        pairs, tables = self._tables(paths)
        source, receiver, table = np.array(pairs, dtype=np.int64).T.copy()
        kernels = [rail.kernel if isinstance(rail, RailPoles) else rail for rail in tables]
        poles = max((len(rail.poles) for rail in tables if isinstance(rail, RailPoles)), default=0)
        scatters = np.array([not isinstance(rail, RailPoles) for rail in tables])
        rows, taps = self.kernel.weights.shape if scatters.any() else (1, 1)
        decay, residue = np.zeros((len(tables), 2, poles)), np.zeros((len(tables), CELLS + 1, 2, poles))
        scattered = np.zeros((len(tables), rows, taps))
        for t, rail in enumerate(tables):
            if isinstance(rail, RailPoles):
                own, found = len(rail.poles), over_the_bay(rail.residues)
                decay[t, 0, :own], decay[t, 1, :own] = rail.poles.real, rail.poles.imag
                residue[t, :, 0, :own], residue[t, :, 1, :own] = found.real, found.imag
            else:
                scattered[t] = rail.weights
        return Channels(
            source=source,
            receiver=receiver,
            table=table,
            first=np.searchsorted(source, np.arange(len(paths) + 1)),
            place=_starts(paths) / self.kernel.spacing,
            stride=self.kernel.speed * self.kernel.time_step / self.kernel.spacing,
            decay=decay.reshape(len(tables), 2 * poles),
            residue=residue.reshape(len(tables), CELLS + 1, 2 * poles),
            now=np.array([over_the_bay(kernel.weights[:, 0]) for kernel in kernels]),
            scattered=scattered,
            scatters=scatters,
        )

    def static_compliance(self, paths: Sequence[Path]) -> Array:
        """Mean over a bay."""
        pairs, tables = self._tables(paths)
        found = np.zeros((len(paths), len(paths)))
        for source, receiver, table in pairs:
            rail = tables[table]
            kernel = rail.kernel if isinstance(rail, RailPoles) else rail
            found[receiver, source] = kernel.weights.sum(axis=1).mean()
        squares, vectors = np.linalg.eigh(0.5 * (found + found.T))
        return np.asarray((vectors * np.maximum(squares, 0.0)) @ vectors.T)

    def most_compliance(self, paths: Sequence[Path]) -> float:
        """Under the force itself."""
        return float(self.kernel.weights.sum(axis=1).max())

    def alternating(self, paths: Sequence[Path]) -> tuple[float, float]:
        """The least of all places in a bay; an endless rail carries impacts away."""
        signs = (-1.0) ** np.arange(self.memory)
        return float((self.kernel.weights @ signs).min()), 0.0

    def judge(self, displaced: Array) -> None:
        """Nothing: an endless rail bends little."""

    def limits(self, resonance: float, stiffness: float, path: Path) -> Iterator[Limit]:
        """As of one wheel on a rail."""
        mass = self.kernel.track.mass_per_length * self.kernel.spacing
        yield "the passing of sleepers v/L", self.kernel.speed / self.kernel.spacing, 20.0
        yield "the contact resonance on a bay of rail", np.sqrt(stiffness / mass) / (2.0 * np.pi), 5.0


def _starts(paths: Sequence[Path]) -> Array:
    """Positions of the contacts at step zero, m."""
    return np.array([path.positions[0] for path in paths])
