"""Records of a case in time, by each of its laws: what every kind lays out of them, and over frequency."""

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity.arguments import Array, Flags
from asperity.scenes import schema
from asperity.schema import Values, rolling
from asperity.spectra import band_levels, psd, spectrum_segment


class RecordedRuns:
    """Runs of a case of any kind by its laws: bodies that roll over a structure, or a bearing that turns."""

    if TYPE_CHECKING:  # each kind has these
        case: Any
        runs: Mapping[str, Any]

    @property
    def first(self) -> Any:
        """The run by the main law."""
        return next(iter(self.runs.values()))

    def stacked(self, name: str) -> Array:
        """Stack one record of all runs, (laws, contacts or sensors, ...), by the name of its attribute."""
        return np.stack([getattr(run, name) for run in self.runs.values()])

    # over frequency: all records in segments of one length, which make the lines of all spectra

    @cached_property
    def segment(self) -> int:
        """Length of these segments, in time steps."""
        return spectrum_segment(len(self.first.time), self.case.recorded_step)

    def psd(self, signals: Array) -> Array:
        """One-sided PSDs (..., f) of records (..., n), on all lines from zero; none of what does not vary."""
        found = psd(signals, self.case.recorded_step, segment=self.segment)[1]
        return np.where(np.ptp(signals, axis=-1, keepdims=True) > 0.0, found, 0.0)

    @cached_property
    def frequency(self) -> Array:
        """All lines (f,), from zero, Hz."""
        return np.fft.rfftfreq(self.segment, self.case.recorded_step)

    @cached_property
    def shown(self) -> Flags:
        """Which lines a result holds: up to the edge of the one-third octave of the highest frequency."""
        return (self.frequency > 0.0) & (self.frequency <= 1.13 * self.case.highest_frequency)

    def levels(self, density: Array, reference: float = 1.0) -> Array:
        """One-third-octave levels (..., b), dB, of PSDs on all lines."""
        highest = self.case.highest_frequency
        return band_levels(self.frequency, density, reference, high=highest)[1]

    @cached_property
    def force_psd(self) -> Array:
        """PSDs of the forces of all contacts (laws, c, f), N²/Hz, on all lines."""
        return self.psd(self.stacked("contact_force"))

    @cached_property
    def force_levels(self) -> Array:
        """Levels of the forces of all contacts (laws, c, b), dB re 1 N."""
        return self.levels(self.force_psd)

    @cached_property
    def band(self) -> Array:
        """Centres of the one-third octaves (b,), Hz."""
        highest = self.case.highest_frequency
        return band_levels(self.frequency, self.force_psd, high=highest)[0]


def recorded_group(computed: RecordedRuns) -> Values:
    """Lay out what every run has recorded in time: forces of all contacts, and where its energy went."""
    runs = computed.runs.values()
    forces = computed.stacked("contact_force")
    return {
        rolling.LAW: list(computed.runs),
        rolling.TIME: computed.first.time,
        rolling.CONTACT: 1 + np.arange(forces.shape[1]),
        rolling.CONTACT_FORCE: forces,
        schema.ENERGY_TERM: list(computed.first.energy.shares),
        schema.ENERGY: [list(run.energy.shares.values()) for run in runs],
        schema.ENERGY_RESIDUAL: [run.energy.residual for run in runs],
    }
