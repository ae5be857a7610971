"""A folder of labelled signals, one file for each member of a study of bearings: for those who classify."""

import io
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray

from asperity import files
from asperity.arguments import Array, file_path, one_of, require, shown
from asperity.case import any_case, bearing
from asperity.case.ball_bearing import BallBearingCase
from asperity.errors import InputError
from asperity.results import save, variable
from asperity.sensing import through_path, with_noise
from asperity.store import content_key
from asperity.structures.ball_bearing import PARTS
from asperity.studies.axes import VARIANT, written_out
from asperity.studies.definition import Member
from asperity.studies.member import SIGNAL
from asperity.text_files import write_csv
from asperity.units import quantity, unit_in

FORMATS = ("nc", "npy", "wav")
LABELS = "labels.csv"
UNIT = "m/s2"
ALWAYS = ("speed", "radial", "axial", "seed")
"""Keys that label every signal, beside those that are swept and what the fault is."""
FAULT: dict[str, Any] = {
    "on": "none", "shape": "none", "length": 0.0, "width": 0.0, "depth": 0.0, "angle": np.nan, "ball": 0
}  # fmt: skip
"""What labels a fault, with what stands where there is none."""
FULL = 32_767
"""Number of a WAV file, of 16 bits, that stands for full scale."""
MOST_LEVEL = 200.0  # dB


@dataclass(frozen=True)
class SignalSet:
    """Signals that a study of bearings writes: the acceleration at its sensors, labelled.

    Parameters
    ----------
    folder : path
        Where they go, one file for each member, with ``labels.csv``.
    format : {"nc", "npy", "wav"}
        netCDF with its labels; a NumPy array (n,), of several sensors (n, sensors); or WAV of 16 bits, whose
        full scale, in m/s2, stands in ``labels.csv``. Beside the last two lies the case in TOML.
    path : path, optional
        File with the impulse response of the path from the bearing to the sensor, as `through_path` takes
        it: ``.npy``, ``.npz``, ``.wav``, or a table, of which a column of times (s) may come first.
    path_rate : str or float, optional
        Samples per second of that response, where its file does not say: Hz, or with a unit.
    noise : str, optional
        Level of white noise that is added behind the path: ``"20 dB"`` below the rms of the signal, or its
        rms, ``"0.5 m/s^2"``. It differs from member to member, and is the same again.

    Raises
    ------
    InputError
        If one of these is wrong, or the file with the response cannot be read.

    Examples
    --------
    >>> from asperity.studies.signals import SignalSet
    >>> SignalSet("set", "npy", noise="20 dB").labels_file.name
    'labels.csv'
    """

    folder: str | os.PathLike[str]
    format: str = "nc"
    path: str | os.PathLike[str] | None = None
    path_rate: str | float | None = None
    noise: str | None = None

    def __post_init__(self) -> None:
        one_of("format of the signals", self.format, FORMATS)
        given = self.path_rate is None or self.path is not None
        require(given, "sampling rate of the path", "a rate without a path", "the file with the response")
        _ = self.labels_file, self._response, self._noise

    @cached_property
    def labels_file(self) -> Path:
        """The table of labels."""
        return file_path("folder of the signals", self.folder, "the path of a folder") / LABELS

    @cached_property
    def _response(self) -> tuple[Array, float] | None:
        """Impulse response and its sampling rate, Hz; None for none."""
        if self.path is None:
            return None
        file = file_path("path to the sensor", self.path, "the path of a file")
        rate = self.path_rate
        rate = quantity(rate, "Hz") if isinstance(rate, str) else rate
        if rate is not None or file.suffix.lower() == ".wav":
            return bearing.read_signal(file, rate)
        times, values = (bearing.read_signal(file, 1.0, column=n)[0] for n in (1, 2))
        steps = np.diff(times)
        even = steps.size > 0 and steps.min() > 0.0 and np.ptp(steps) <= 0.01 * steps.mean()
        require(even, f"times in {file.name}", "uneven ones", "equal steps, s", "Or give the sampling rate.")
        return values, float(1.0 / steps.mean())

    @cached_property
    def _noise(self) -> dict[str, float]:
        """Level of the noise, as `with_noise` takes it; empty for none."""
        if self.noise is None:
            return {}
        received, allowed = shown(self.noise), "a level as '20 dB', or an rms above 0 as '0.5 m/s^2'"
        try:
            is_level = unit_in(self.noise) == "dB"
            found = quantity(self.noise, "dB" if is_level else "m/s^2")
        except (InputError, TypeError):
            raise InputError("noise of the signals", received, allowed) from None
        right = abs(found) <= MOST_LEVEL if is_level else 0.0 < found < np.inf
        require(right, "noise of the signals", received, f"{allowed}, within ±{MOST_LEVEL:g} dB")
        return {"below" if is_level else "rms": found}

    @classmethod
    def of(cls, asked: "str | os.PathLike[str] | SignalSet", members: Iterable[Member]) -> "SignalSet":
        """Take signals that are asked for; refuse cases without any, and a folder that cannot be written."""
        found = asked if isinstance(asked, cls) else cls(asked)  # type: ignore[arg-type]
        for case in (member.case for member in members if member.case):
            if not isinstance(case, BallBearingCase):
                raise InputError("signals", f"a {case.kind} case", 'a case of kind = "ball-bearing"')
        files.refuse_unwritable(found.labels_file.parent, "folder of the signals", "Choose another one.")
        return found

    def write(self, member: Member, table: xarray.Dataset) -> dict[str, Any]:
        """Write the signal of a member, where it is not there yet, and return its labels."""
        assert isinstance(member.case, BallBearingCase)
        case, (heard, rate) = member.case, self._response or (np.zeros(0), 0.0)
        digest = content_key("signal", member.key, self.format, heard, rate, self._noise).partition("-")[2]
        file = self.labels_file.parent / f"{digest[:16]}.{self.format}"
        labels = {"file": file.name, **_labels(member, case)}
        if self.format != "wav" and file.exists():
            return labels
        signal = np.asarray(table[SIGNAL].values, dtype=float)
        if self._response:
            signal = np.stack([through_path(each, case.sampling_rate, heard, rate) for each in signal])
        if self._noise:
            seeds = [int(digest[n : n + 8], 16) for n in range(0, 32, 8)]
            signal = np.stack([with_noise(each, [*seeds, n], **self._noise) for n, each in enumerate(signal)])
        if self.format == "wav":
            labels[f"full_scale [{UNIT}]"] = float(np.abs(signal).max()) or 1.0
        if not file.exists():
            self._write(file, case, signal, labels)
        return labels

    def _write(self, file: Path, case: BallBearingCase, signal: Array, labels: Mapping[str, Any]) -> None:
        """Write a signal (sensors, n), its case first."""
        if self.format == "nc":
            told = {name.partition(" [")[0]: value for name, value in labels.items() if name != "file"}
            time = np.arange(signal.shape[1]) / case.sampling_rate
            held = {
                "time": variable("time", time, "s", "time"),
                "sensor": variable("sensor", np.array(case.sensors), "rad", "angle from the radial load"),
                SIGNAL: variable(("sensor", "time"), signal, UNIT, "acceleration at the sensor"),
            }
            save(xarray.DataTree(xarray.Dataset(held, attrs={**told, "case": case.text})), file)
            return
        files.write_bytes(file.with_suffix(".toml"), case.text.encode())
        columns, image = signal.T if len(signal) > 1 else signal[0], io.BytesIO()
        if self.format == "npy":
            np.save(image, columns)
        else:
            from scipy.io import wavfile

            shares = columns / labels[f"full_scale [{UNIT}]"]
            wavfile.write(image, round(case.sampling_rate), np.round(FULL * shares).astype(np.int16))
        files.write_bytes(file, image.getvalue())

    def label(self, labels: Mapping[tuple[int, ...], Mapping[str, Any]]) -> None:
        """Write the table of labels, the members in the order of the study."""
        rows = [labels[index] for index in sorted(labels)]
        if rows:
            longest = max(rows, key=len)  # of those with most faults
            names = list(longest)
            told = [[row.get(name, _absent(name)) for name in names] for row in rows]
            write_csv(self.labels_file, names, told)


def _labels(member: Member, case: BallBearingCase) -> dict[str, Any]:
    """What is told of the signal of a member, in SI, units behind the names."""
    found: dict[str, Any] = {}
    for section, keys in (case.faults or {"fault": case.fault}).items():
        own = {"on": keys.on, "ball": keys.ball if keys.on == "ball" else 0}
        (fault,) = keys.faults or (None,)
        for name, missing in FAULT.items():
            given = own[name] if name in own else getattr(fault, name, missing)
            found[_titled(f"{section}.{name}")] = given if fault else missing
    for name in dict.fromkeys((*ALWAYS, *member.values)):
        section, _, key = name.rpartition(".")
        if name == VARIANT:
            found[name] = member.values[name]
        elif _titled(name) not in found:
            value = getattr(getattr(case, section) if section else case, key)
            number = np.nan if value is None else value
            found[_titled(name)] = number if type(number) in (int, float) else written_out(value)
    turning = case.kinematics
    found |= {f"{part}_tone [Hz]": turning.tone(part) for part in PARTS}
    found |= {"cage_tone [Hz]": turning.cage, "sampling_rate [Hz]": case.sampling_rate}
    return found | {"unit": UNIT, "law": case.laws[0]}


def _absent(title: str) -> Any:
    """What stands for the label of a fault that a bearing does not have."""
    return FAULT.get(title.partition(".")[2].partition(" [")[0], np.nan)


def _titled(dotted: str) -> str:
    """Name of a key with its unit."""
    unit = any_case.entry_of(BallBearingCase, dotted).unit if dotted != VARIANT else None
    return f"{dotted} [{unit}]" if unit and unit != "1" else dotted
