"""Fits a case to what was measured: the case with the values found, as a table and on a page."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from asperity import __version__, files
from asperity.arguments import Array
from asperity.case.any_case import AnyCase, entries
from asperity.case.cases import read_case
from asperity.case.form import content, file_digest, in_toml
from asperity.case.toml import toml_text
from asperity.cli.commands import mark_of, refuse_other_case, require_writable, taken_file
from asperity.cli.running import doubted
from asperity.errors import InputError
from asperity.fitting.fitted import Fitted
from asperity.fitting.running import chosen_free, fitted, measured_for
from asperity.observables import observable
from asperity.observables.beside_result import magnitudes
from asperity.observables.reading import read_where
from asperity.progress import progress_bar
from asperity.reporting import data
from asperity.reporting.figure import PageFigure
from asperity.reporting.fit_figures import Compared, fit_figure
from asperity.reporting.page import figures_page
from asperity.reporting.tables import ReportTable, number_cells, table, text_cells
from asperity.terminal import say, say_files, say_table
from asperity.text_files import csv_text
from asperity.threads import one_thread_in_linear_algebra
from asperity.written_numbers import capital, count_of, rounded

CASE = "fitted.toml"
FILES = {"case": CASE, "table": "fitted.csv", "page": "fitted.html"}
HEADING = (
    "quantity",
    "source",
    "axis",
    "at",
    "units",
    "measured",
    "uncertainty (dB)",
    "before",
    "fitted",
    "measured over fitted (dB)",
)


def fit_case(
    path: Path,
    measured: Sequence[Path],
    directory: Path | None,
    *,
    free: Sequence[str] = (),
    where: Sequence[str] = (),
    what: str | None = None,
    starts: int | None = None,
    overwrite: bool = False,
) -> dict[str, Any]:
    """Fit a case to files of what was measured, and write the case found, into a folder, else beside it."""
    folder = path.parent if directory is None else directory
    case = read_case(path)
    _refuse_keys(case, measured)
    data_of_case = measured_for(case, list(measured) or None, read_where(where), what)
    chosen = chosen_free(case, data_of_case, list(free) or None)
    require_writable(folder)
    asked = json.dumps(
        [
            content(case, file_digest),
            [
                [each.what, content(each.conditions), each.at.tolist(), repr(each.values.tolist())]
                for each in data_of_case
            ],
            [[each.name, each.low, each.high] for each in chosen],
        ]
    )
    spectra = dict.fromkeys(each.entry.dotted for each in chosen if each.band is not None)
    tables = {dotted: f"fitted_{dotted.replace('.', '_')}.csv" for dotted in spectra}
    written = {name: folder / file for name, file in {**FILES, **tables}.items()}
    if not overwrite:
        _refuse_other(asked, written)
    doubts = doubted(case, path.name)
    with files.alone_in(folder), progress_bar() as progress, one_thread_in_linear_algebra():
        found = fitted(case, data_of_case, chosen, progress, starts)
        with files.together(folder, last=CASE) as new:
            files.write_bytes(new / FILES["table"], csv_text(HEADING, _rows(found)).encode())
            files.write_bytes(new / FILES["page"], _page(found).encode())

            def put_beside(dotted: str, levels: Array) -> str:
                text = csv_text(["wavelength (m)", "level (dB re 1 um)"], levels.tolist())
                files.write_bytes(new / tables[dotted], text.encode())
                return tables[dotted]

            keys = in_toml(found.case, in_memory=put_beside)
            text = _origin(found, path) + toml_text({"kind": case.kind, **keys})
            files.write_bytes(new / CASE, f"{mark_of('fitted', asked, text)}{text}".encode())
    _say(found)
    written = {what: file for what, file in written.items() if file.exists()}
    say_files(written)
    return {"case": path.resolve(), **_document(found), "warnings": doubts, "files": written}


def _refuse_keys(case: AnyCase, measured: Sequence[Path]) -> None:
    """Tell a key that stands where a file is meant: one option has one key."""
    keys = {entry.dotted for entry in entries(type(case))}
    for file in measured:
        if str(file).split("=")[0].strip() in keys and not file.exists():
            received = f"{str(file)!r}, a key of the case"
            allowed = "files of what was measured"
            raise InputError("--to", received, allowed, "Write --free before each key.")


def _refuse_other(asked: str, written: dict[str, Path]) -> None:
    """Let a fit replace what it has written itself; other files of these names stay."""
    case = written["case"]
    refuse_other_case("fitted", asked, case, "fit")
    for file in written.values():
        if file.exists() and not case.exists():
            raise taken_file(file, "fit")


def _origin(found: Fitted, path: Path) -> str:
    """What was fitted from what, in comments above the case."""
    lines = [f"Fitted by asperity {__version__}: {path.name} with values from"]
    for each in found.measured:
        records = f", mean of {each.records} measurements" if each.records > 1 else ""
        lines.append(f"  {each.what} in {each.source}{records}: {count_of(each.count, 'value')}")
    lines += [f"{each.name} = {each.words}, 95 %" for each in found.estimates]
    lines += [each.words for each in found.undetermined]
    lines.append(f"Left: {rounded(found.rms(), 2)} dB rms; before {rounded(found.rms(before=True), 2)} dB.")
    return "".join(f"# {line}\n" for line in lines) + "\n"


# --- what is said


def _say(found: Fitted) -> None:
    """Say what is not known, then what was found."""
    for sentence in found.open_sentences:
        say(capital(sentence))
    rows = [
        (each.name, each.before_in_words, each.free.words(each.value), each.interval_in_words)
        for each in found.estimates
    ]
    say_table("Fitted", ("key", "before", "fitted", "95 %"), rows, width=120)
    for sentence in found.remarks:
        say(sentence)


def _document(found: Fitted) -> dict[str, Any]:
    """What programs are told, in SI."""
    return {
        "summary": found.sentence,
        "undetermined": [{"key": each.free.name, "with": dict(each.others)} for each in found.undetermined],
        "fitted": [
            {
                "key": each.name,
                "units": each.free.units,
                "before": each.free.before if each.free.given else None,
                "value": each.value,
                "interval": each.interval,
                "interval_stops": {
                    end: stop or None for end, stop in zip(("least", "largest"), each.stops, strict=True)
                },
                "limits": [each.free.low, each.free.high],
                "limit": each.limit or None,
            }
            for each in found.estimates
        ],
        "repeats": [
            {
                "quantity": each.what,
                "source": each.source,
                "measurements": each.records,
                "differ": each.differing,
            }
            for each in found.measured
            if each.records > 1
        ],
        "correlations": found.correlations,
        "rms": found.rms(),
        "rms_before": found.rms(before=True),
        "left_out": found.left_out,
        "others": list(found.rivals),
        "columns": HEADING,
        "rows": _rows(found),
    }


def _compared(found: Fitted) -> list[Compared]:
    """Measurements beside what is predicted; of complex values the magnitude."""
    compared = []
    for each, before, after in zip(found.measured, found.predicted_before, found.predicted, strict=True):
        of = observable(each.what)
        deviation = of.uncertainty if each.uncertainty is None else each.uncertainty
        told = f"{each.source}, mean of {each.records}" if each.records > 1 else each.source
        compared.append(
            Compared(
                of.name,
                of.units,
                of.axis,
                told,
                at=each.at,
                measured=magnitudes(each.values),
                before=magnitudes(before),
                fitted=magnitudes(after),
                deviation=np.broadcast_to(np.asarray(deviation, dtype=float), each.at.shape),
                decade=of.decade,
            )
        )
    return compared


def _rows(found: Fitted) -> list[list[Any]]:
    rows = []
    for each, left in zip(_compared(found), found.residuals(), strict=True):
        columns = (each.at, each.measured, each.deviation, each.before, each.fitted, left[: len(each.at)])
        for at, measured, deviation, before, after, over in np.stack(columns, axis=1).tolist():
            row = [each.what, each.title, each.axis, at, each.units, measured, deviation, before, after, over]
            rows.append(row)
    return rows


def _page(found: Fitted) -> str:
    parts = fit_figure(_compared(found), stated=found.stated)
    figure = PageFigure.of("fitted", "Measured, before and fitted", parts)
    return figures_page(
        "A case fitted to what was measured",
        capital(found.headline),
        [figure, *_tables(found)],
        {"case": CASE, "numbers (CSV)": FILES["table"]},
    )


def _tables(found: Fitted) -> list[ReportTable]:
    """Values with their intervals, and how they depend on each other."""
    estimates = found.estimates
    columns = {
        "key": text_cells(each.name for each in estimates),
        "before": text_cells(each.before_in_words for each in estimates),
        "fitted": text_cells(each.free.words(each.value) for each in estimates),
        "95 %": text_cells(each.interval_in_words for each in estimates),
        "limits": text_cells(
            f"{each.free.words(each.free.low)} to {each.free.words(each.free.high)}" for each in estimates
        ),
        "limits are": text_cells(each.free.range_source for each in estimates),
    }
    note = " ".join(map(capital, [*found.open_sentences, *found.remarks]))
    tables = [table("values", "Values", columns, note)]
    inside = [each.name for each in estimates if each.interval is not None]
    if len(inside) > 1:
        heads = {"": text_cells(inside)}
        heads |= {
            name: number_cells(column, data.signed)
            for name, column in zip(inside, found.correlations.T.round(2), strict=True)
        }
        note = "Correlations of what was fitted, of logarithms where that is fitted by its logarithm."
        tables.append(table("correlations", "Correlations", heads, note))
    return tables
