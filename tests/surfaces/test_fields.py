"""Fields of generated strips: kept in a file, so that memory holds none of them."""

import gc
import threading

import numpy as np
import pytest

from asperity.surfaces import strip as module
from asperity.surfaces.strip import Fields


class Made:
    """Fields that tell how often they were made."""

    def __init__(self, shape=(100, 3)):
        self.shape, self.names = shape, []

    def of(self, number):
        def make():
            self.names.append(number)
            return np.arange(float(np.prod(self.shape))).reshape(self.shape) + 1e4 * number

        return make


def test_fields_are_made_once_and_none_is_held_in_memory():
    fields, made = Fields(), Made()
    for _ in range(2):
        for number in range(5):
            found = fields.rows(number, made.of(number), 10, 30)
            assert np.array_equal(found, made.of(number)()[10:30])
            made.names.pop()
    assert made.names == [0, 1, 2, 3, 4]
    assert fields.nbytes == 0


def test_rows_outlive_the_fields_they_are_of():
    fields, made = Fields(), Made()
    found = fields.rows("a", made.of(1), 0, 100)
    del fields
    gc.collect()
    assert np.array_equal(found, made.of(1)())


def test_where_there_are_too_many_all_are_made_again(monkeypatch):
    monkeypatch.setattr(module, "BYTES_KEPT", 4 * 100 * 3 * 8)
    fields, made = Fields(), Made()
    for number in (0, 1, 2, 3, 4, 3, 0):
        assert fields.rows(number, made.of(number), 5, 6)[0, 0] == 1e4 * number + 15
    assert made.names == [0, 1, 2, 3, 4, 3, 0]


def _no_file(**_):
    raise OSError(28, "No space left on device")


class _Full:
    """A file on a disk that fills up while it is written."""

    def close(self):
        pass

    def seek(self, _):
        pass

    def write(self, _):
        raise OSError(28, "No space left on device")


@pytest.mark.parametrize("file", [_no_file, lambda **_: _Full()])
def test_without_a_file_few_fields_are_held_in_memory(monkeypatch, file):
    monkeypatch.setattr("tempfile.TemporaryFile", file)
    monkeypatch.setattr(module, "BYTES_IN_MEMORY", 4 * 100 * 3 * 8)
    fields, made = Fields(), Made()
    for _ in range(2):
        for number in (0, 1, 2, 3):
            assert fields.rows(number, made.of(number), 5, 6)[0, 0] == 1e4 * number + 15
    assert made.names == [0, 1, 2, 3]
    fields.rows(4, made.of(4), 0, 1)
    assert fields.nbytes == 100 * 3 * 8


def test_neighbours_are_kept_whatever_their_size(monkeypatch):
    monkeypatch.setattr(module, "BYTES_KEPT", 0)
    fields, made = Fields(), Made()
    for number in (0, 1, 0, 1, 0, 1):
        fields.rows(number, made.of(number), 0, 1)
    assert made.names == [0, 1]


def test_threads_read_beside_each_other():
    fields, made, wrong = Fields(), Made((2000, 5)), []

    def read(number):
        expected = made.of(number)()
        for first in range(0, 2000, 50):
            if not np.array_equal(
                fields.rows(number, made.of(number), first, first + 50), expected[first:][:50]
            ):
                wrong.append((number, first))

    threads = [threading.Thread(target=read, args=(number % 3,)) for number in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong
