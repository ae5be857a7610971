"""Signals in universal files (dataset 58), by pyuff, and in Parquet, by pyarrow: read in a sandbox."""

import importlib.util
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import NDArray, listed, require, shown
from asperity.sandbox import Answer, sandboxed
from asperity.surfaces.readers import arrays
from asperity.surfaces.readers.hints import SPELLING, Spelling, spelled
from asperity.universal_files import TIME_RESPONSE
from asperity.written_numbers import count_of

Found = tuple[NDArray[Any], list[str], float | None]
"""Values (n,) or (n, columns), titles of the columns, and the sampling rate, Hz, where it is stated."""


def refuse_without(package: str, extra: str, source: str, received: str) -> None:
    """Refuse what needs a package that is missing."""
    remedy = f'Install it: pip install "asperity[{extra}]".'
    there = importlib.util.find_spec(package) is not None
    require(there, source, received, f"it with the package {package}", remedy)


def read(file: Path, ending: str, array: str | None) -> Found:
    """Signals of a universal file or of one in Parquet, by the reader of its ending, in a sandbox."""
    reader, kind, called, package, extra = READERS[ending]
    refuse_without(package.partition(".")[0], extra, file.name, called)
    asked = [array, file.name, asdict(SPELLING.get())]
    (titles, rate), (values,) = sandboxed(
        reader, file, asked, source=file.name, kind=kind, packages=[package]
    )
    return values, list(titles), rate


def _chosen(names: list[str], array: str | None, source: str, spelling: dict[str, Any]) -> str:
    """Name of the signal that is asked for, or of the only one."""
    with spelled(Spelling(**spelling)):
        chosen = arrays.only_one(names, source, "signals") if array is None else array
    require(chosen in names, f"array in {source}", shown(chosen), f"one of: {listed(names)}", "Choose one.")
    return chosen


def responses_of_universal(path: str, array: str | None, source: str, spelling: dict[str, Any]) -> Answer:
    """Time response of a universal file that is named, or the only one."""
    import pyuff

    opened = pyuff.UFF(path)
    kinds = [str(kind).strip().removesuffix(".0") for kind in opened.get_set_types()]
    sets = [opened.read_sets(n) for n, kind in enumerate(kinds) if kind == "58"]
    responses = [each for each in sets if each["func_type"] == TIME_RESPONSE]
    received = f"datasets {listed(kinds) or 'of no kind'}, {len(responses)} of them time responses"
    require(responses, source, received, "a time response in a dataset 58", "Export the signal again.")
    words = [str(each["id1"]).strip() for each in responses]
    several = Counter(words)
    names = [
        f"{word} {each['rsp_node']}" if several[word] > 1 else word
        for word, each in zip(words, responses, strict=True)
    ]
    chosen = _chosen(names, array, source, spelling)
    found = responses[names.index(chosen)]
    values = np.asarray(found["data"])
    told = int(found["num_pts"])
    received = f"{count_of(told, 'sample')}, by its head, in {len(values)}"
    remedy = "Copy the file again."
    require(told == len(values), source, received, "as many as it holds", remedy)
    if found["abscissa_spacing"] == 1:
        return [[], 1.0 / float(found["abscissa_inc"])], [values]
    return [["time (s)", chosen], None], [np.column_stack([found["x"], values])]


def columns_of_parquet(path: str, array: str | None, source: str, spelling: dict[str, Any]) -> Answer:
    """Columns of numbers of a Parquet file, side by side, or one of a list of signals that is named."""
    import pyarrow as pa
    from pyarrow import parquet

    table = parquet.read_table(path, use_threads=False, memory_map=False)
    lists = [field.name for field in table.schema if pa.types.is_list(field.type)]
    if lists:
        words = [field.name for field in table.schema if pa.types.is_string(field.type)]
        rows = table.column(lists[0]).to_pylist() if not words else None
        names = (
            table.column(words[0]).to_pylist() if words else [str(n) for n in range(1, len(rows or ()) + 1)]
        )
        chosen = _chosen(names, array, source, spelling)
        row = table.column(lists[0])[names.index(chosen)].values
        return [[], None], [np.asarray(row, dtype=float)]
    titles = [
        field.name
        for field in table.schema
        if pa.types.is_floating(field.type) or pa.types.is_integer(field.type)
    ]
    if array is not None:
        allowed = f"one of: {listed(titles)}"
        require(array in titles, f"array in {source}", shown(array), allowed, "Choose one.")
        return [[], None], [np.asarray(table.column(array), dtype=float)]
    received = f"columns {listed(table.column_names) or 'of no name'}"
    require(titles, source, received, "columns of numbers, or a list of them in each row")
    return [titles, None], [np.column_stack([np.asarray(table.column(name), dtype=float) for name in titles])]


READERS = {
    ".uff": (responses_of_universal, "universal", "a universal file", "pyuff", "uff"),
    ".parquet": (columns_of_parquet, "Parquet", "a Parquet file", "pyarrow.parquet", "parquet"),
}
"""By the kind of a file: its reader, its name in messages, and the package that it needs, with its extra."""
