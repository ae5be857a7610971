"""What is read from the signal of a bearing: which part is struck, at which speed, and how sure that is.

Spectra of the signal and of its envelope (`envelopes`), the band that rings (`kurtogram`), lines where they
are expected (`lines`), over orders where the speed changes (`orders`), what else stands out (`prominence`),
what it may mean (`hypotheses`), and what is said of it (`decision`, `confidence`, `verdict`).
"""

from asperity.diagnostics.decision import diagnose, diagnose_together
from asperity.diagnostics.diagnosis import Diagnosis
from asperity.diagnostics.envelopes import (
    ISO_BANDS,
    Spectrum,
    amplitude_spectrum,
    band_deviations,
    band_velocities,
    envelope_spectrum,
    one_anderon,
    prewhitened,
)
from asperity.diagnostics.hypotheses import Hypothesis, Tone
from asperity.diagnostics.kurtogram import Kurtogram, impulsive_band, kurtogram
from asperity.diagnostics.lines import LineFamily, clear_families, explained_lines, find_lines
from asperity.diagnostics.tacho import Tacho
from asperity.diagnostics.verdict import diagnosis_sentence

__all__ = [
    "ISO_BANDS",
    "Diagnosis",
    "Hypothesis",
    "Kurtogram",
    "LineFamily",
    "Spectrum",
    "Tacho",
    "Tone",
    "amplitude_spectrum",
    "band_deviations",
    "band_velocities",
    "clear_families",
    "diagnose",
    "diagnose_together",
    "diagnosis_sentence",
    "envelope_spectrum",
    "explained_lines",
    "find_lines",
    "impulsive_band",
    "kurtogram",
    "one_anderon",
    "prewhitened",
]  # fmt: skip
