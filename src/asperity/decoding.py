"""Text that people have written: UTF-8, or UTF-16 as PowerShell writes it."""

from __future__ import annotations

import codecs

from asperity.errors import InputError

_MARKS = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def decoded(content: bytes, source: str, allowed: str) -> str:
    """Decode the content of a text file.

    Parameters
    ----------
    content : bytes
        What the file holds.
    source : str
        Its name, for messages.
    allowed : str
        What may stand there, for messages.

    Returns
    -------
    str
        The text, without a mark of its encoding.

    Raises
    ------
    InputError
        If it is neither UTF-8 nor marked UTF-16; says which encoding it probably is.
    """
    remedy = "Save the file as UTF-8."
    try:
        if content.startswith(_MARKS):
            return content.decode("utf-16")
        if b"\0" in content:
            halves = content[: len(content) // 2 * 2]
            utf16 = not any(halves[0::2]) or not any(halves[1::2])
            received = "text in UTF-16 without a byte-order mark" if utf16 else "bytes that are no text"
            raise InputError(source, received, allowed, remedy)
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        encoding = error.encoding[:6].upper()  # whatever the order of bytes
        received = f"a byte that is no {encoding} in line {line}"
        raise InputError(source, received, allowed, remedy) from None
