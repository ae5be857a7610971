"""Every public name has a docstring with an example, and every example does what it says."""

import doctest
import inspect

import pytest

import asperity

NAMES = sorted(set(asperity.__all__) - {"__version__", "laws"})
SHORT = {"laws": ["hertz", "linear"], "duration": 5e-3, "surface": {"spectrum": "iso3095"}}


@pytest.mark.parametrize("name", [*NAMES, "laws.register"])
def test_the_example_of_a_public_name_holds(name, tmp_path, monkeypatch):
    """In the examples `case` stands for any case that is soon computed."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))
    thing = asperity.laws.register if name == "laws.register" else getattr(asperity, name)
    doc = inspect.getdoc(thing)
    assert "Examples\n--------" in doc
    names = {"case": asperity.BallOnBeam(**SHORT)}
    example = doctest.DocTestParser().get_doctest(doc, names, name, None, None)
    assert len(example.examples) >= 2
    said = []
    doctest.DocTestRunner().run(example, out=said.append)
    assert not said, "".join(said)
