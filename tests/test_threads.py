"""How many threads a computation takes."""

import pytest
from threadpoolctl import threadpool_info

from asperity.errors import InputError
from asperity.threads import one_thread_in_linear_algebra, processors, thread_count


def test_one_per_processor_unless_the_environment_says_otherwise(monkeypatch):
    monkeypatch.delenv("ASPERITY_THREADS", raising=False)
    assert thread_count() == processors() >= 1
    monkeypatch.setenv("ASPERITY_THREADS", "3")
    assert thread_count() == 3


@pytest.mark.parametrize("wrong", ["0", "-1", "two", "1.5"])
def test_a_wrong_number_is_explained(monkeypatch, wrong):
    monkeypatch.setenv("ASPERITY_THREADS", wrong)
    with pytest.raises(InputError, match=f"received '{wrong}'; allowed: a whole number greater than 0"):
        thread_count()


def test_linear_algebra_has_one_thread_inside_and_its_own_again_outside():
    def threads():
        return [library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"]

    with one_thread_in_linear_algebra():
        inside = threads()
    before = threads()
    with one_thread_in_linear_algebra():
        pass
    assert set(inside) == {1}
    assert threads() == before
