"""Tables of what is refused: each row is asked, and its message is looked at."""

import pytest

from asperity.errors import InputError


def refusals(*rows, of=lambda question: question(), error=InputError):
    """A test of rows (what is given, message): `of` refuses what is given, by default a call."""

    @pytest.mark.parametrize(("given", "message"), rows)
    def refused(given, message):
        with pytest.raises(error, match=message):
            of(given)

    return refused
