"""What the compiler takes for each kernel of a case, from an empty folder and in one process.

Each row is one kernel for one set of argument types. Its time is its own: without that of the kernels that it
had compiled first. Told apart are numba's part (bytecode to intermediate code) and LLVM's (optimisation and
machine code), in which what a kernel calls counts again wherever it is compiled into another.

    python benchmarks/compile_times.py demo
    python benchmarks/compile_times.py wheel-on-rail --signatures
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
import tomllib
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from numba.core import event
from numba.core.codegen import CPUCodeLibrary


@dataclass(eq=False)
class Compiled:
    """A kernel for one set of argument types, and what its compilation took without others inside it, s."""

    name: str
    arguments: str
    size: int = 0  # bytes of intermediate code that LLVM was given
    seconds: float = 0.0
    llvm: float = 0.0
    within: list[str] = field(default_factory=list)  # whose compilation waited for it


class Listener(event.Listener):
    """Takes down what is compiled, with a stack of clocks: only the innermost runs."""

    def __init__(self) -> None:
        self.all: list[Compiled] = []
        self.open: list[Compiled] = []
        self.mark = 0.0

    def charge(self, *, llvm: bool = False) -> None:
        """Give the time since the last call to the innermost kernel."""
        now = time.process_time()
        if self.open:
            self.open[-1].seconds += now - self.mark
            self.open[-1].llvm += (now - self.mark) * llvm
        self.mark = now

    def on_start(self, event: event.Event) -> None:
        """Begin a kernel, inside of those that are open."""
        self.charge()
        function = event.data["dispatcher"].py_func
        module = function.__module__.removeprefix("asperity.").removeprefix("kernels.")
        new = Compiled(f"{module}.{function.__qualname__}", ", ".join(map(str, event.data["args"])))
        new.within = [each.name for each in self.open]
        self.all.append(new)
        self.open.append(new)

    def on_end(self, event: event.Event) -> None:
        """End it."""
        self.charge()
        self.open.pop()

    def timed(self, method: Callable[..., Any]) -> Callable[..., Any]:
        """A method of a library whose time is LLVM's."""

        def wrapper(library: Any, *arguments: Any) -> Any:
            self.charge()
            found = method(library, *arguments)
            self.charge(llvm=True)
            if self.open and method.__name__ == "finalize":
                self.open[-1].size += len(str(library._final_module))
            self.mark = time.process_time()
            return found

        return wrapper


def compile_case(kind: str, folder: Path, *, ahead: bool) -> None:
    """Run a default case, or compile its kernels ahead only, from nothing kept, in this process."""
    os.environ |= {"ASPERITY_KERNELS": str(folder / "kernels"), "ASPERITY_CACHE": str(folder / "cache")}
    tempfile.tempdir = str(folder)  # kernels are looked for there, too
    from asperity.case.cases import as_case, demo_case, template
    from asperity.running import run
    from asperity.scenarios import compiling

    compiling.processors = lambda: 1  # else another takes its share
    case = demo_case() if kind == "demo" else as_case(tomllib.loads(template(kind)))
    if ahead:
        compiling.compile_kernels(lambda *_: None)
    else:
        run(case)


def main() -> int:
    """Compile and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("kind", choices=("demo", "ball-on-beam", "wheel-on-rail"))
    parser.add_argument("--ahead", action="store_true", help="only what is compiled before the work")
    parser.add_argument("--signatures", action="store_true", help="print argument types")
    arguments = parser.parse_args()
    listener = Listener()
    for name in ("add_ir_module", "finalize", "_get_module_for_linking"):
        setattr(CPUCodeLibrary, name, listener.timed(getattr(CPUCodeLibrary, name)))
    event.register("numba:compile", listener)
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        compile_case(arguments.kind, Path(folder), ahead=arguments.ahead)
    times = Counter(each.name for each in listener.all)
    print(f"{'kernel':52} {'s':>6} {'numba':>6} {'LLVM':>6} {'kB IR':>6}")
    for each in sorted(listener.all, key=lambda each: -each.seconds):
        name = f"{each.name} ({times[each.name]} signatures)" if times[each.name] > 1 else each.name
        front = each.seconds - each.llvm
        print(f"{name:52} {each.seconds:6.2f} {front:6.2f} {each.llvm:6.2f} {each.size / 1000:6.0f}")
        if arguments.signatures:
            print(f"    ({each.arguments})\n    within {' > '.join(each.within) or 'nothing'}")
    whole, llvm = sum(e.seconds for e in listener.all), sum(e.llvm for e in listener.all)
    print(f"{f'{len(listener.all)} in all':52} {whole:6.2f} {whole - llvm:6.2f} {llvm:6.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
