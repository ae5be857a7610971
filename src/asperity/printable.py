"""Text of others, made fit to be shown: a name is read, it controls nothing."""

import unicodedata

_UNSEEN = ("Cc", "Cf", "Cs", "Zl", "Zp")
"""Classes of characters that are not seen but act: controls, directions of writing, half pairs, breaks."""


def printable(text: str, *, lines: bool = False) -> str:
    r"""Spell out the characters of a text by others that would act instead of being seen.

    ``\x1b`` for an escape, ``\u202e`` for a change of direction, ``\xff`` for a byte of a file name that is
    no UTF-8. `lines` says whether line ends and tabs may stay.
    """
    if text.isprintable():
        return text
    acting = {c for c in set(text) - set("\n\t" if lines else "") if unicodedata.category(c) in _UNSEEN}
    return text.translate({ord(character): _spelled(character) for character in acting})


def _spelled(character: str) -> str:
    byte = ord(character) - 0xDC00  # how Python carries bytes that are no UTF-8
    if 0x80 <= byte <= 0xFF:
        return f"\\x{byte:02x}"
    return character.encode("unicode_escape").decode("ascii")
