"""Interrupts that come where Python lets no error through."""

import signal
import time
import weakref
from importlib.machinery import ExtensionFileLoader
from importlib.util import module_from_spec, spec_from_file_location
from types import FunctionType

import pytest

from asperity.interrupts import interruptible


class Thing:
    """What a weak reference can point to."""


def test_an_interrupt_in_a_callback_is_not_lost():
    """Imports end in such callbacks: without another try the program would go on as if nothing had come."""
    thing = Thing()
    reference = weakref.ref(thing, lambda gone: signal.raise_signal(signal.SIGINT))

    def work():
        nonlocal thing
        thing = None
        time.sleep(5.0)

    with pytest.raises(KeyboardInterrupt), interruptible():
        work()
    assert reference() is None


def test_other_errors_in_callbacks_are_told_as_before():
    thing = Thing()
    reference = weakref.ref(thing, lambda gone: 1 / 0)
    with pytest.MonkeyPatch.context() as patch:
        told = []
        patch.setattr("sys.unraisablehook", told.append)
        with interruptible():
            del thing
    assert reference() is None
    assert [lost.exc_type for lost in told] == [ZeroDivisionError]


def interrupted_in(work):
    """Whether an interrupt that comes while this work is done waits for its end."""
    whole = []
    with pytest.raises(KeyboardInterrupt), interruptible():  # noqa: PT012
        work(whole)
        time.sleep(5.0)
    return whole == ["done"]


def test_an_interrupt_waits_until_a_kernel_is_compiled():
    """Half a compiled function ended the process by signal 11."""

    def compiles(whole):
        signal.raise_signal(signal.SIGINT)
        whole.append("done")

    there = {"__name__": "numba.core.compiler", "signal": signal}
    assert interrupted_in(FunctionType(compiles.__code__, there))


def test_an_interrupt_waits_until_a_compiled_module_is_set_up():
    """Half a module of machine code may end the process later."""

    class Loader(ExtensionFileLoader):
        def create_module(self, spec):
            return None

        def exec_module(self, module):
            signal.raise_signal(signal.SIGINT)
            module.whole.append("done")

    def loads(whole):
        spec = spec_from_file_location("compiled", "compiled.so", loader=Loader("compiled", "compiled.so"))
        module = module_from_spec(spec)
        module.whole = whole
        spec.loader.exec_module(module)

    assert interrupted_in(loads)
