"""A track, a quantity of it in closed form among those that cases are fitted to, and a cache of their own."""

import pytest

import asperity
from asperity import observables
from known_keys import RUBBER, RUBBERY, TRACK


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))


@pytest.fixture(scope="session")
def track():
    return asperity.WheelOnRail(surface={"spectrum": "iso3095"}, track=TRACK)


@pytest.fixture
def rubber(monkeypatch):
    """The quantity, among those that cases are fitted to."""
    monkeypatch.setitem(observables.BUILT_IN, RUBBER, RUBBERY)
