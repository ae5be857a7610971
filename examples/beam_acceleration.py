"""What a rolling ball makes of a beam's roughness: acceleration at five sensors.

A steel ball rolls at 1 m/s over two steel beams that differ in their roughness alone: a "smooth" one of
0.02 µm rms and a rough one of 0.2 µm. Both have the same seed: the rough texture is ten times the smooth one.

What is asserted:

- from 200 Hz to 5 kHz the rough beam is louder by at least 10 dB at every sensor (13 to 19 dB, by sensor and
  seed). A linear contact would give 20 dB, but on the rough beam the ball is in the air for a quarter of the
  time. The power up to 200 Hz is nearly the same: the beam answers to the moving weight, not to texture;
- the rough beam's spectrum, averaged over the sensors, peaks within 3 % (or one line of the spectrum) of each
  natural frequency of the bare beam up to 5 kHz. So does the smooth beam's up to 2.5 kHz. Higher up, near the
  resonance of the ball on its contact, a ball that never lets go is part of the structure and shifts the
  peaks, by up to 8 %.

Run: python beam_acceleration.py [FOLDER]
"""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import xarray
from matplotlib.figure import Figure

import asperity
from asperity.reference.materials import material
from asperity.reporting.style import frequency_axis, sequence, styled
from asperity.structures.beam import Beam

CASE = asperity.BallOnBeam(
    laws=["areal"],
    start="0.3 m",
    duration="0.4 s",
    surface={"rms": "0.02 um", "longest": "0.4 mm", "shortest": "32 um"},
    ball={"radius": "10 mm", "load": "5 N"},
    contact={"window": "0.4 mm", "samples": 2, "sample_length": "2 mm"},
)
ROUGHNESS = {"smooth": "0.02 um", "rough": "0.2 um"}
HIGHEST = 5000.0  # Hz
BEAM = Beam.rectangular(1.0, 50e-3, 10e-3, material("steel"), highest_frequency=HIGHEST)


def spectra(result: xarray.DataTree) -> xarray.DataArray:
    """Acceleration PSD by sensor and frequency, (m/s²)²/Hz."""
    density: xarray.DataArray = result["spectra"].to_dataset()["acceleration_psd"]
    return density.sel(law="areal").sel(frequency=slice(10.0, HIGHEST))


def level_difference(densities: dict[str, xarray.DataArray], low: float, high: float) -> np.ndarray:
    """Level of the rough beam over the smooth one between two frequencies, dB, by sensor."""
    power = {name: d.sel(frequency=slice(low, high)).sum("frequency") for name, d in densities.items()}
    return 10 * np.log10((power["rough"] / power["smooth"]).values)


def detuning(density: xarray.DataArray) -> np.ndarray:
    """Distance of the highest peak round each natural frequency from it, Hz, on the mean of the sensors."""
    mean, natural = density.mean("sensor"), BEAM.natural_frequencies
    between = np.concatenate([[10.0], np.sqrt(natural[1:] * natural[:-1]), [HIGHEST]])
    peaks = [float(mean.sel(frequency=slice(*edges)).idxmax()) for edges in pairwise(between)]
    return np.abs(np.array(peaks) - natural)


def draw(densities: dict[str, xarray.DataArray], file: Path) -> None:
    with styled():
        figure = Figure(figsize=(9.6, 6.4))
        panels = figure.subplots(2, 1, sharex=True, sharey=True)
        for axes, (name, density) in zip(panels, densities.items(), strict=True):
            for frequency in BEAM.natural_frequencies:
                axes.axvline(frequency, color="0.75", lw=0.8, zorder=1)
            for colour, (position, line) in zip(sequence(5), density.groupby("sensor"), strict=True):
                level = 10 * np.log10(line.squeeze().values)
                axes.plot(density.frequency, level, color=colour, lw=1.1, label=f"{position:g} m")
            axes.set_title(f"{name} beam, {ROUGHNESS[name].replace('um', 'µm')} rms")
            axes.set_ylabel("acceleration PSD / dB re 1 (m/s²)²/Hz")
            frequency_axis(axes, 50.0, HIGHEST, "frequency / Hz" if axes is panels[-1] else "")
        panels[0].set_ylim(-100, 20)
        panels[0].legend(title="sensor at", loc="upper left", ncols=5)
        note = "grey: natural frequencies of the bare beam"
        panels[1].annotate(note, (0.01, 0.95), xycoords="axes fraction", va="top")
        figure.savefig(file, dpi=150, facecolor="white")


def main(folder: Path = Path()) -> dict[str, float]:
    results = {name: asperity.run(CASE.with_(surface={"rms": rms})) for name, rms in ROUGHNESS.items()}
    densities = {name: spectra(result) for name, result in results.items()}
    draw(densities, folder / "beam_acceleration.png")
    smooth, rough = densities["smooth"], densities["rough"]
    allowed = np.maximum(0.03 * BEAM.natural_frequencies, np.diff(rough.frequency.values[:2]))
    low = BEAM.natural_frequencies < 2500.0
    numbers = {
        "least_level_difference": float(level_difference(densities, 200.0, HIGHEST).min()),
        "level_difference_below_200_hz": float(level_difference(densities, 10.0, 200.0).max()),
        "peaks_of_rough_beam": int(np.sum(detuning(rough) <= allowed)),
        "peaks_of_smooth_beam": int(np.sum((detuning(smooth) <= allowed)[low])),
        "time_out_of_contact": float(results["rough"]["rolling"]["contact_loss_share"][0]),
    }
    assert numbers["least_level_difference"] > 10.0
    assert numbers["peaks_of_rough_beam"] == len(BEAM.natural_frequencies)
    assert numbers["peaks_of_smooth_beam"] == np.sum(low)
    return numbers


if __name__ == "__main__":
    for name, value in main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path()).items():
        print(f"{name} = {value:.4g}")
