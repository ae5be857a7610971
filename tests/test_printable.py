"""Characters that act instead of being seen are spelled out."""

import pytest

from asperity.printable import printable


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("map [um] v2 – höhe, 粗さ.npy", "map [um] v2 – höhe, 粗さ.npy"),
        ("a\N{NO-BREAK SPACE}b", "a\N{NO-BREAK SPACE}b"),
        ("\x1b[31mred", "\\x1b[31mred"),
        ("\x9b31m", "\\x9b31m"),  # the same in one character
        ("a\x07\x08\r\x7f", "a\\x07\\x08\\r\\x7f"),
        ("beam\u202excod.exe", "beam\\u202excod.exe"),
        ("\u2066a\u2069\u200f", "\\u2066a\\u2069\\u200f"),
        ("a\u2028b", "a\\u2028b"),
        ("a\ud800b", "a\\ud800b"),
        ("\udcff.toml", "\\xff.toml"),  # how Python carries a byte of a file name that is no UTF-8
        ("a\nb\tc", "a\\nb\\tc"),
    ],
)
def test_what_would_act_is_spelled_out(text, shown):
    assert printable(text) == shown
    assert printable(shown) == shown
    assert not any(ord(character) < 32 for character in printable(text))
    printable(text).encode("utf-8")


def test_line_ends_and_tabs_may_stay():
    assert printable("a\n\tb\r\x1b", lines=True) == "a\n\tb\\r\\x1b"
