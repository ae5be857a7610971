"""Writes docs/reference/result_file.md from the schema: ``python tests/reporting/schema_page.py``."""

from pathlib import Path

from asperity.scenes import schema
from asperity.schema import (
    VERSION,
    Attribute,
    Entry,
    bearing,
    contact,
    convergence,
    measured,
    provenance,
    rolling,
    spectra,
)

SHARED = (provenance, contact, rolling, spectra, convergence, measured)

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "result_file.md"
HEAD = f"""# What `run.nc` holds

Version {VERSION} of the schema: the attribute `schema_version` of a file names its own. A file of another
version is refused, with what to do. Every variable has `units` and `long_name`; where values are missing
(NaN), `missing` says why. "Not in all" says which results have what not all have.
"""
OF_BEARINGS = """A run of a ball bearing holds these and, of the above, the attributes of the root and of
`scenario`, `contact: validity`, laws, time and frequency, force levels in bands with how sure they are, what
was measured, and the energy balance.
"""


def contents_of(*modules):
    """Entries and attributes that modules define, in their order."""
    held = [value for module in modules for value in vars(module).values()]
    items = [item for value in held for item in (value.values() if isinstance(value, dict) else (value,))]
    kinds = ([item for item in items if isinstance(item, kind)] for kind in (Entry, Attribute))
    return tuple(list(dict.fromkeys(each)) for each in kinds)


def table(entries, attributes):
    lines = []
    if attributes:
        lines += ["| attribute | unit | what | not in all |", "|---|---|---|---|"]
        for item in attributes:
            place = f"{item.group or '/'}: {item.name}"
            lines.append(f"| `{place}` | {item.units} | {item.meaning} | {item.condition} |")
        lines.append("")
    lines += ["| variable | dimensions | unit | what | not in all |", "|---|---|---|---|---|"]
    for entry in entries:
        more = (
            f"; attribute {', '.join(f'`{name}`' for name in entry.attributes)}" if entry.attributes else ""
        )
        lines.append(
            f"| `{entry.path}` | {', '.join(entry.dims)} | {entry.units} | {entry.long_name}{more} "
            f"| {entry.condition} |"
        )
    return "\n".join(lines)


def page():
    """Text of the page."""
    parts = [HEAD, "## Bodies that roll, of any kind\n", table(*contents_of(*SHARED)), ""]
    shared = [item for items in contents_of(*SHARED) for item in items]
    own = ([item for item in items if item not in shared] for items in contents_of(schema))
    parts += ["## What depends on the scene\n", table(*own), ""]
    parts += ["## Ball bearings\n", OF_BEARINGS, table(*contents_of(bearing)), ""]
    return "\n".join(parts)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
