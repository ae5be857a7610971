"""Keys and values of a case as TOML text."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from asperity.config.content import described_value


def toml_text(data: Mapping[str, Any]) -> str:
    """Write keys and values as TOML that reads as the same; those at the top come before the sections."""
    sections = {name: value for name, value in data.items() if isinstance(value, Mapping)}
    lines = _lines({name: value for name, value in data.items() if name not in sections})
    for name, section in sections.items():
        lines += ["", f"[{_text(name)}]", *_lines(section)]
    return "\n".join(lines).lstrip() + "\n"


def _lines(data: Mapping[str, Any]) -> list[str]:
    return [f"{_text(name)} = {toml_value(value)}" for name, value in data.items()]


def _text(name: str) -> str:
    bare = name.isascii() and name.replace("-", "_").isidentifier()
    return name if bare else toml_value(name)


def toml_value(value: object) -> str:
    """Write one value as it stands behind the = of a key."""
    if isinstance(value, Mapping):
        inside = ", ".join(f"{_text(name)} = {toml_value(item)}" for name, item in value.items())
        return f"{{ {inside} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(toml_value, value))}]"
    if isinstance(value, float):
        return repr(value)  # inf and nan, too, are spelled as in Python
    return json.dumps(value, ensure_ascii=False, default=described_value).replace("\x7f", "\\u007f")
