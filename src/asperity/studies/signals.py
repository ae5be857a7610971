"""A folder of labelled signals, one file for each member of a study of bearings: for those who classify."""

import io
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import xarray

from asperity import files
from asperity.arguments import Array, FilePath, file_path, one_of
from asperity.case import any_case
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.errors import InputError, ShortRecordWarning
from asperity.results import save, variable
from asperity.schema.bearing import TACHO
from asperity.speeds import SpeedCourse, covered, speed_at
from asperity.store import content_key
from asperity.structures.rolling_bearing import PARTS
from asperity.studies import common_schema
from asperity.studies.axes import AS_IT_IS, VARIANT, written_out
from asperity.studies.definition import Member
from asperity.studies.draws import chance
from asperity.studies.member import SIGNAL
from asperity.studies.sensor_path import DrawnPath, MeasuredPath, Noise, noise_of, path_to_sensor, with_noise
from asperity.text_files import write_csv
from asperity.universal_files import Channel, universal_text
from asperity.wave_files import wave_bytes
from asperity.written_numbers import count_of, rounded

FORMATS = ("nc", "npy", "wav", "uff", "parquet")
LABELS = "labels.csv"
UNIT = "m/s2"
ALWAYS = ("speed", "radial", "axial", "seed")
"""Keys that label every signal, beside those that are swept and what the fault is."""
FAULT: dict[str, Any] = {
    "on": "none", "shape": "none", "length": 0.0, "width": 0.0, "depth": 0.0, "angle": np.nan, "ball": 0
}  # fmt: skip
"""What labels a fault, with what stands where there is none."""
BEARING_ALONE = ""
"""Label that is not written: the content of a signal before path and noise."""


@dataclass(frozen=True)
class SignalSet:
    """Signals that a study of bearings writes: the acceleration at its sensors, labelled.

    Parameters
    ----------
    folder : path
        Where they go, one file for each member, with ``labels.csv``.
    format : {"nc", "npy", "wav", "uff", "parquet"}
        netCDF with its labels; a NumPy array (n,), of several sensors (n, sensors); WAV of 16 bits, whose
        full scale, in m/s2, stands in ``labels.csv`` and in the file; a universal file (dataset 58); or
        Parquet in the common schema of the package ``bearing-datasets``, which opens the folder. Beside
        NumPy, WAV and universal files lies the case in TOML.
    path : path or str, optional
        File with the impulse response of the path from the bearing to the sensor, as `through_path` takes
        it: ``.npy``, ``.npz``, ``.mat``, ``.wav``, or a table, of which a column of times (s) may come first.
        Or resonances that are drawn for each signal, ``"1..6 kHz, 3 resonances"``.
    path_rate : str or float, optional
        Samples per second of that response, where its file does not say: Hz, or with a unit.
    noise : str, optional
        Level of white noise that is added behind the path: ``"20 dB"`` below the rms of the signal, or its
        rms, ``"0.5 m/s^2"``; or a span from which it is drawn, ``"0..30 dB"``. It differs from member to
        member, and is the same again.

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

    folder: FilePath
    format: str = "nc"
    path: FilePath | None = None
    path_rate: str | float | None = None
    noise: str | None = None

    def __post_init__(self) -> None:
        one_of("format of the signals", self.format, FORMATS)
        _ = self.labels_file, self._path, self._noise
        if self.format == "parquet":
            common_schema.check_installed()

    @cached_property
    def labels_file(self) -> Path:
        """The table of labels."""
        return file_path("folder of the signals", self.folder, "the path of a folder") / LABELS

    @cached_property
    def _path(self) -> MeasuredPath | DrawnPath | None:
        return path_to_sensor(self.path, self.path_rate)

    @cached_property
    def _noise(self) -> Noise | None:
        return noise_of(self.noise)

    @classmethod
    def of(cls, asked: "FilePath | SignalSet", members: Iterable[Member]) -> "SignalSet":
        """Take signals that are asked for; refuse cases without any, and a folder that cannot be written."""
        found = asked if isinstance(asked, cls) else cls(asked)  # type: ignore[arg-type]
        for case in (member.case for member in members if member.case):
            if not isinstance(case, BearingUnderLoad):
                raise InputError("signals", f"a {case.kind} case", 'a case of kind = "ball-bearing"')
        files.refuse_unwritable(found.labels_file.parent, "folder of the signals", "Choose another one.")
        return found

    def write(self, member: Member, table: xarray.Dataset) -> dict[str, Any]:
        """Write the signal of a member, where it is not there yet, and return its labels."""
        assert isinstance(member.case, BearingUnderLoad)
        case = member.case
        between = [each.content if each else None for each in (self._path, self._noise)]
        digest = content_key("signal", member.key, self.format, between).partition("-")[2]
        file = self.labels_file.parent / self._name(digest[:16])
        signal = np.asarray(table[SIGNAL].values, dtype=float)
        labels = {"file": file.relative_to(self.labels_file.parent).as_posix(), **_labels(member, case)}
        labels[BEARING_ALONE] = content_key("bearing", signal, case.sampling_rate)
        if self._path:
            signal = self._path.behind(signal, case.sampling_rate, chance("path", member.key, between[0]))
            labels["path"] = os.fspath(self.path or "")
        if self._noise:
            random = chance("level", member.key, between)
            level = self._noise.level(random)
            labels["noise_below [dB]" if self._noise.is_level else "noise_rms [m/s2]"] = level
            how = {"below" if self._noise.is_level else "rms": level}
            seed = int(random.integers(2**32))
            signal = np.stack([with_noise(each, [seed, n], **how) for n, each in enumerate(signal)])
        if self.format == "wav":
            labels[f"full_scale [{UNIT}]"] = float(np.abs(signal).max()) or 1.0
        if not file.exists():
            self._write(file, case, signal, labels)
        return labels

    def _name(self, digest: str) -> str:
        return common_schema.recording_path(digest) if self.format == "parquet" else f"{digest}.{self.format}"

    @staticmethod
    def _channels(case: BearingUnderLoad, signal: Array) -> list[Channel]:
        """Signals (sensors, n) of a case, and a tacho where its speed changes."""
        step = 1.0 / case.sampling_rate
        found = [
            Channel("acceleration", each, step, UNIT, place=n, about=(f"sensor at {rounded(angle)} rad",))
            for n, (each, angle) in enumerate(zip(signal, case.sensors, strict=True), 1)
        ]
        if isinstance(case.speed, SpeedCourse):
            turning = speed_at(case.speed, np.arange(signal.shape[1]) / case.sampling_rate)
            found.append(Channel("tacho", turning, step, TACHO.units, about=(TACHO.long_name,)))
        return found

    def _write(self, file: Path, case: BearingUnderLoad, signal: Array, labels: Mapping[str, Any]) -> None:
        """Write a signal (sensors, n), its case first."""
        if self.format == "nc":
            told = {
                name.partition(" [")[0]: value
                for name, value in labels.items()
                if name not in ("file", BEARING_ALONE)
            }
            time = np.arange(signal.shape[1]) / case.sampling_rate
            held = {
                "time": variable("time", time, "s", "time"),
                "sensor": variable("sensor", np.array(case.sensors), "rad", "angle from the radial load"),
                SIGNAL: variable(("sensor", "time"), signal, UNIT, "acceleration at the sensor"),
                TACHO.name: variable("time", speed_at(case.speed, time), TACHO.units, TACHO.long_name),
            }
            save(xarray.DataTree(xarray.Dataset(held, attrs={**told, "case": case.text})), file)
            return
        if self.format == "parquet":
            common_schema.write_recording(file, case, signal)
            return
        files.write_bytes(file.with_suffix(".toml"), case.text.encode())
        columns = signal.T if len(signal) > 1 else signal[0]
        if self.format == "npy":
            image = io.BytesIO()
            np.save(image, columns)
            content = image.getvalue()
        elif self.format == "wav":
            full = labels[f"full_scale [{UNIT}]"]
            content = wave_bytes(columns, case.sampling_rate, full, UNIT, what="acceleration")
        else:
            content = universal_text(self._channels(case, signal)).encode()
        files.write_bytes(file, content)

    def label(self, labels: Mapping[tuple[int, ...], Mapping[str, Any]]) -> None:
        """Write the table of labels, the members in the order of the study.

        Each signal once, whatever path and noise add to it: the case as it is, which no variant changes,
        gives way to one that is the same.
        """
        once: dict[str, Mapping[str, Any]] = {}
        for row in (labels[index] for index in sorted(labels)):
            same = row[BEARING_ALONE]
            if same not in once or once[same].get(VARIANT) == AS_IT_IS:
                once[same] = {name: value for name, value in row.items() if name != BEARING_ALONE}
        rows = list(once.values())
        files_of = {row["file"] for row in labels.values()}
        if left := len(files_of) - len(rows):
            for name in files_of - {row["file"] for row in rows}:
                files.discard(self.labels_file.parent / name)
            ShortRecordWarning.warn(
                f"{count_of(left, 'signal')} of {len(files_of)} are left out of the set: they are as others "
                "but for path and noise. Seeds change nothing in a bearing without roughness, waviness or "
                "slip of its cage."
            )
        if rows:
            longest = max(rows, key=len)  # of those with most faults
            names = list(longest)
            told = [[row.get(name, _absent(name)) for name in names] for row in rows]
            write_csv(self.labels_file, names, told)
        if rows and self.format == "parquet":
            common_schema.write_metadata(self.labels_file.parent, rows)


def _labels(member: Member, case: BearingUnderLoad) -> dict[str, Any]:
    """What is told of the signal of a member, in SI, units behind the names."""
    found: dict[str, Any] = {}
    for section, keys in (case.faults or {"fault": case.fault}).items():
        own = {"on": keys.part, "ball": keys.number if keys.part == "ball" else 0}
        fault = keys.fault
        for name, missing in FAULT.items():
            given = own[name] if name in own else getattr(fault, name, missing)
            found[_titled(f"{section}.{name}")] = given if fault else missing
    for name in dict.fromkeys((*ALWAYS, *member.values, *member.drawn)):
        if name == VARIANT:
            found[name] = member.values[name]
        elif _titled(name) not in found:
            value = attrgetter(name)(case)
            number = np.nan if value is None else mean_speed(case) if name == "speed" else value
            found[_titled(name)] = number if type(number) in (int, float) else written_out(value)
    turning = case.kinematics
    share = mean_speed(case) / float(case.speed)
    found |= {f"{part}_tone [Hz]": share * turning.tone(part) for part in PARTS}
    found |= {"cage_tone [Hz]": share * turning.cage, "sampling_rate [Hz]": case.sampling_rate}
    return found | {"unit": UNIT, "law": case.laws[0]}


def mean_speed(case: BearingUnderLoad) -> float:
    """Speed of a record, Hz, on average where it changes."""
    return covered(case.speed, case.duration) / case.duration


def _absent(title: str) -> Any:
    """What stands for the label of a fault that a bearing does not have."""
    return FAULT.get(title.partition(".")[2].partition(" [")[0], np.nan)


def _titled(dotted: str) -> str:
    """Name of a key with its unit."""
    unit = any_case.entry_of(BearingUnderLoad, dotted).unit if dotted != VARIANT else None
    return f"{dotted} [{unit}]" if unit and unit != "1" else dotted
