"""Textures of a rail: measured, synthesised, and defects; and what a rail's and a wheel's have in common."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, PlainValidator

from asperity.config.form import key
from asperity.config.keys import Choice, ChoiceOrFile, Length, LineFile, MapFile, Number, Position, YesNo
from asperity.config.sections import LATERAL, MeasuredLine, Surface
from asperity.config.tables import TABLE_OF_LEVELS, problems_of_table, read_levels
from asperity.errors import InputError

RAIL_SPECTRA = ("iso3095", "cnossos-average")
PROCESSING = ("fill", "spikes", "curvature")

Spectrum = Annotated[
    str | Path | NDArray[np.float64], PlainValidator(ChoiceOrFile(RAIL_SPECTRA, TABLE_OF_LEVELS, columns=2))
]
Step = Annotated[str, BeforeValidator(Choice(PROCESSING))]


class MeasuredLines(MeasuredLine):
    """Measured lines along a rail or around a tread."""

    line: LineFile | None = key(None, "measured long line, or several side by side", example='"lines.csv"')
    line_distance: Length | None = key(
        None,
        "distance across between neighbouring lines; a single line holds all across",
        otherwise="for a single line",
        example='"5 mm"',
        goes_with="line",
        within=("1 um", "1 m", "lines lie beside each other on one wheel or rail"),
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

    file: MapFile | None = key(
        None, "measured map: the samples, and the path where it is long enough", example='"rail.x3p"'
    )
    longest: Length | None = key(
        None,
        "longest wavelength of the samples",
        otherwise="with rms 20 half-widths of the smooth contact, else all they hold",
        example='"20 mm"',
        within=("1 um", "1 km", "waves lie between contacts and tracks"),
    )
    shortest: Length | None = key(
        None,
        "shortest wavelength of the samples",
        otherwise="with rms four times contact.spacing, else all they hold",
        example='"1.25 mm"',
        within=("0.1 um", "10 m", "waves lie between contacts and tracks"),
    )
    spectrum: Spectrum | None = key(
        None, "one-third-octave wavelength spectrum of the rail", example='"iso3095"'
    )
    lateral: Annotated[float, BeforeValidator(Number(above=0, infinite=True))] = key(
        1.0,
        "correlation length across over that along the rail, at every wavelength; inf: the same all across",
        goes_with="spectrum",
        within=LATERAL,
    )
    continuation: Annotated[str, BeforeValidator(Choice(("refuse", "mirror", "repeat")))] = key(
        "refuse", "how a record that is shorter than the run goes on"
    )
    accept_levels: YesNo = key(False, "take levels beyond 60 dB re 1 um as they are")
    corrugation: Length | None = key(
        None,
        "amplitude of a corrugation on top of the rail's texture",
        example='"25 um"',
        within=("1 nm", "10 mm", "corrugation lies between"),
    )
    corrugation_wavelength: Length | None = key(
        None,
        "its wavelength",
        otherwise="must be given",
        example='"40 mm"',
        goes_with="corrugation",
        within=("0.1 mm", "100 m", "corrugation lies between"),
    )
    corrugation_bandwidth: Annotated[float, BeforeValidator(Number(above=0, at_most=3))] | None = key(
        None,
        "its bandwidth in octaves",
        otherwise="a sine",
        example="0.3",
        goes_with="corrugation",
        within=(0.001, 3, "a narrower one is a sine: leave it out"),
    )
    joint_depth: Length | None = key(
        None,
        "depth of a dipped joint, which direct and table see",
        example='"1 mm"',
        within=("1 um", "100 mm", "dips lie between"),
    )
    joint_length: Length = key(
        "1 m", "length of the dip", goes_with="joint_depth", within=("1 mm", "100 m", "dips lie between")
    )
    joint_position: Position | None = key(
        None,
        "position of the joint, from the sleeper that start counts from",
        otherwise="the middle of the run",
        example='"10 m"',
        goes_with="joint_depth",
        within=("0 m", "100 km", "tracks are rolled over for less"),
    )
    smooth: YesNo = key(False, "a rail without texture")

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
