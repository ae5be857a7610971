"""Text for terminals and pipes that lack some characters: what stands for them, instead of question marks."""

from __future__ import annotations

import codecs
import unicodedata

NAME = "asperity-plain"
"""Name of the error handler for ``reconfigure(errors=…)``."""

_PLAIN = {
    "−": "-", "–": "-", "—": "-", "×": "x", "·": "*", "±": "+/-", "∓": "-/+", "≤": "<=", "≥": ">=",
    "→": "->", "←": "<-", "°": "deg", "√": "sqrt", "∝": "~", "“": '"', "”": '"', "„": '"', "’": "'",
    "α": "alpha", "β": "beta", "δ": "delta", "Δ": "Delta", "ζ": "zeta", "η": "eta", "λ": "lambda",
    "μ": "u", "ν": "nu", "π": "pi", "σ": "sigma", "Σ": "Sigma", "τ": "tau", "ω": "omega", "Ω": "Ohm",
}  # fmt: skip


def ascii_text(text: str) -> str:
    """Write text in ASCII: ``-`` for a minus sign, ``u`` for micro; ``?`` for what has no likeness."""
    return "".join(character if character.isascii() else _alike(character) for character in text)


def _alike(character: str) -> str:
    parts = [_PLAIN.get(part, part) for part in unicodedata.normalize("NFKD", character)]
    return _PLAIN.get(character) or "".join(part for part in parts if part.isascii()) or "?"


def _stand_in(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return ascii_text(error.object[error.start : error.end]), error.end


codecs.register_error(NAME, _stand_in)
