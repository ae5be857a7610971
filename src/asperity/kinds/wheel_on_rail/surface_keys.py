"""Textures of a rail: measured, synthesised, and defects; and what a rail's and a wheel's have in common."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from asperity.config import values
from asperity.config.form import key, optional
from asperity.config.sections import LATERAL, MeasuredLine, Surface
from asperity.config.tables import TABLE_OF_LEVELS, problems_of_table, read_levels
from asperity.errors import InputError

RAIL_SPECTRA = ("iso3095", "cnossos-average")
PROCESSING = ("fill", "spikes", "curvature")

Spectrum = Annotated[
    str | Path | NDArray[np.float64], values.ChoiceOrFile(RAIL_SPECTRA, TABLE_OF_LEVELS, columns=2)
]
Step = Annotated[str, values.Choice(PROCESSING)]


class MeasuredLines(MeasuredLine):
    """Measured lines along a rail or around a tread."""

    line: values.LineFile | None = optional("lines.csv", "measured long line, or several side by side")
    line_distance: values.Length | None = optional(
        "5 mm",
        "distance across between neighbouring lines; a single line holds all across",
        "for a single line",
        "1 um to 1 m: lines lie beside each other on one wheel or rail",
        goes_with="line",
    )
    processing: tuple[Step, ...] = key(
        (), "steps of EN 15610 that are applied to measured lines", goes_with="line"
    )

    def problems_of_processing(self) -> Iterator[InputError]:
        """Each step of the processing once."""
        for step in sorted(set(self.processing)):
            if self.processing.count(step) > 1:
                yield InputError("processing", f'"{step}" more than once', "each step once")


class RailSurface(MeasuredLines, Surface):
    """Texture of the rail: measured or synthesised, with defects on top; or smooth."""

    file: values.MapFile | None = optional(
        "rail.x3p", "measured map: the samples, and the path where it is long enough"
    )
    longest: values.Length | None = optional(
        "20 mm",
        "longest wavelength of the samples",
        "with rms 20 half-widths of the smooth contact, else all they hold",
        "1 um to 1 km: waves lie between contacts and tracks",
    )
    shortest: values.Length | None = optional(
        "1.25 mm",
        "shortest wavelength of the samples",
        "with rms four times contact.spacing, else all they hold",
        "0.1 um to 10 m: waves lie between contacts and tracks",
    )
    spectrum: Spectrum | None = optional("iso3095", "one-third-octave wavelength spectrum of the rail")
    lateral: Annotated[float, values.Number(above=0, infinite=True)] = key(
        1.0,
        "correlation length across over that along the rail, at every wavelength; inf: the same all across",
        LATERAL,
        goes_with="spectrum",
    )
    continuation: Annotated[str, values.Choice(("refuse", "mirror", "repeat"))] = key(
        "refuse", "how a record that is shorter than the run goes on"
    )
    accept_levels: values.YesNo = key(False, "take levels beyond 60 dB re 1 um as they are")
    corrugation: values.Length | None = optional(
        "25 um",
        "amplitude of a corrugation on top of the rail's texture",
        within="1 nm to 10 mm: corrugation lies between",
    )
    corrugation_wavelength: values.Length | None = optional(
        "40 mm",
        "its wavelength",
        "must be given",
        "0.1 mm to 100 m: corrugation lies between",
        goes_with="corrugation",
    )
    corrugation_bandwidth: Annotated[float, values.Number(above=0, at_most=3)] | None = optional(
        0.3,
        "its bandwidth in octaves",
        "a sine",
        "0.001 to 3: a narrower one is a sine: leave it out",
        goes_with="corrugation",
    )
    joint_depth: values.Length | None = optional(
        "1 mm",
        "depth of a dipped joint, which direct and table see",
        within="1 um to 100 mm: dips lie between",
    )
    joint_length: values.Length = key(
        "1 m", "length of the dip", "1 mm to 100 m: dips lie between", goes_with="joint_depth"
    )
    joint_position: values.Position | None = optional(
        "10 m",
        "position of the joint, from the sleeper that start counts from",
        "the middle of the run",
        "0 m to 100 km: tracks are rolled over for less",
        goes_with="joint_depth",
    )
    smooth: values.YesNo = key(False, "a rail without texture")

    @property
    def has_texture(self) -> bool:
        """Whether the rail has any texture or defect."""
        defects = self.corrugation is not None or self.joint_depth is not None
        return self.has_samples or self.has_line or defects

    def problems(self) -> Iterator[InputError]:
        """Sources and defects of the rail's texture that do not exclude one another."""
        yield from self.problems_of_sources()
        yield from self.problems_of_processing()
        if self.smooth and self.has_texture:
            yield InputError("smooth", "true beside a texture", "one of them", "Remove smooth.")
        if self.corrugation is not None and self.corrugation_wavelength is None:
            remedy = 'Add corrugation_wavelength = "40 mm", say.'
            yield InputError("corrugation", "no corrugation_wavelength", "both keys together", remedy)
        yield from problems_of_table(self, "spectrum", read_levels)
