"""Every public name has a docstring with an example, and every example does what it says."""

import doctest
import inspect
import pkgutil
import pydoc
from importlib import import_module

import pytest

import asperity

MODULES = ("laws", "rolling", "synthesis", "diagnostics", "errors")
NAMES = sorted(set(asperity.__all__) - {"__version__", *MODULES})
SHORT = {"laws": ["hertz", "linear"], "duration": 5e-3, "surface": {"spectrum": "iso3095"}}


@pytest.mark.parametrize("name", [*NAMES, "laws.register"])
def test_the_examples_of_a_public_name_hold(name, tmp_path, monkeypatch):
    """Those of its methods, too. In the examples `case` stands for any case that is soon computed."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))
    thing = asperity.laws.register if name == "laws.register" else getattr(asperity, name)
    assert "Examples\n--------" in inspect.getdoc(thing)
    found = doctest.DocTestFinder().find(thing, name, globs={"case": asperity.BallOnBeam(**SHORT)})
    assert len(found[0].examples) >= 2
    said = []
    for example in found:
        example.globs |= {} if example is found[0] else vars(inspect.getmodule(thing))  # of methods
        doctest.DocTestRunner().run(example, out=said.append)
    assert not said, "".join(said)


@pytest.mark.parametrize("name", MODULES)
def test_public_modules_tell_of_all_that_they_offer(name):
    module = getattr(asperity, name)
    things = [getattr(module, each) for each in module.__all__]
    described = [each for each in things if callable(each)]
    assert len(described) >= 4
    for each in described:
        assert len(inspect.getdoc(each)) > 20, each
    assert set(module.__all__) <= set(dir(module))


def callables_of(module):
    """Functions and classes of a module, and the methods of its classes."""
    for name, thing in vars(module).items():
        if not name.startswith("_") and getattr(thing, "__module__", "") == module.__name__:
            yield thing
            if inspect.isclass(thing):
                methods = (each for name, each in vars(thing).items() if not name.startswith("_"))
                yield from filter(inspect.isroutine, methods)


def test_help_names_arrays_in_a_word():
    """It spelled out what NumPy makes an array of: a dozen types for each argument."""
    modules = [each.name for each in pkgutil.walk_packages(asperity.__path__, "asperity.")]
    count = 0
    for module in (name for name in modules if ".kernels" not in name and "__main__" not in name):
        for thing in callables_of(import_module(module)):
            if callable(thing) and (inspect.isroutine(thing) or inspect.isclass(thing)):
                try:
                    told = str(inspect.signature(thing))
                except ValueError:  # one that Python cannot ask
                    continue
                count += "ArrayLike" in told
                assert "numpy._typing" not in told, f"{module}: {thing}"
    assert count > 20
    for thing in filter(callable, (getattr(asperity, name) for name in asperity.__all__)):
        assert "numpy.dtype[" not in pydoc.render_doc(thing, renderer=pydoc.plaintext), thing
