"""Tables of what is refused: each row is asked, and its message is looked at."""

import inspect
import re

import pytest

from asperity.errors import InputError


def refusals(*rows, of=lambda question: question(), error=InputError):
    """A test of rows (what is given, …, message): `of` refuses what is given, by default a call.

    Its further arguments are fixtures; the message is text, or a regular expression.
    """

    @pytest.mark.parametrize("row", rows)
    def refused(row, request):
        *given, message = row
        fixtures = list(inspect.signature(of).parameters)[len(given) :]
        with pytest.raises(error) as caught:
            of(*given, *map(request.getfixturevalue, fixtures))
        told = str(caught.value)
        assert message in told or re.search(message, told), told

    return refused
