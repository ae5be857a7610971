"""The run over frequency: force by law, and how far the laws are from each other."""

from functools import partial

from asperity.schema import Entry, rolling

_entry = partial(Entry, "spectra")
NO_SIGNAL = "there is no signal in these bands, and nothing has no level"
_level = partial(_entry, missing=NO_SIGNAL)

LAW = _entry("law", "1", "contact law")
FREQUENCY = _entry("frequency", "Hz", "frequency")
BAND = _entry("band", "Hz", "one-third-octave band centre")
BAND_TIME_PRODUCT = _entry(
    "band_time_product(band)",
    "1",
    "bandwidth times averaging time; a level has a standard deviation of 4.34/sqrt of it, dB, or more",
    attributes=("least",),
)
LEVEL_DEVIATION = _entry(
    "level_deviation(band)", "dB", "standard deviation of a force level by the chance of one record"
)
START_SHARE = _entry(
    "start_share(band)",
    "1",
    "share of the mean square of the force that is not built up yet in the record",
    "of what rolls over structures whose receptances are known",
    attributes=("most",),
)

CONTACT = _entry("contact", "1", rolling.CONTACTS)
FORCE_PSD = _entry(
    "force_psd(law, frequency)", "N2/Hz", "PSD of the contact force, one-sided, mean of the contacts"
)
FORCE_LEVEL = _level(
    "force_level(law, band)", "dB re 1 N", "contact force level, energy mean of the contacts"
)
CONTACT_FORCE_LEVEL = _level(
    "contact_force_level(law, contact, band)", "dB re 1 N", "level of the force of each contact"
)


def _difference(to: str, law: str, condition: str) -> Entry:
    place = f"force_level_difference_to_{to}(law, band)"
    long_name = f"force level over that of {law}"
    return _level(place, "dB", long_name, condition, attributes=("reference",))


PRACTICE, BARE = "baseline of practice", "baseline on the bare texture"
"""Roles of the laws that all others are compared with; practice is that of CNOSSOS-EU and TWINS."""
FORCE_LEVEL_DIFFERENCES = {
    role: _difference(law.replace("-", "_"), law, f"where the law {law} was rolled")
    for role, law in {PRACTICE: "linear-filtered", BARE: "linear"}.items()
}
"""By the role of the law that is compared with."""
FORCE_LEVEL_DIFFERENCE_TO_REFERENCE = _difference(
    "reference", "the law that solves or scans the whole contact", "where such a law was rolled"
)
