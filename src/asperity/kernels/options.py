"""How kernels are compiled, and kept on disk: here and in `lowering` private names of numba stand.

Kernels of time loops get named tuples of arrays; counting references to those arrays at every call costs ten
times the arithmetic. Functions that allocate nothing do not need to count (``_nrt``), and inside one compiled
loop nothing is left of the calls (``forceinline``).

Entries take the compiler longer than most kernels: numba makes two, for Python and for C, and unpacks
every array of every named tuple in them. So only what Python calls has one, and none has one for C. What
has none is optimised, and made machine code, as part of what has one alone: numba would do both at every
kernel, for it and for all that it calls. Python looks for no garbage meanwhile, which took a third of the
time before LLVM's; the type of an operator on numbers is looked for once, and passes over what kernels do
not contain are left out: 6 to 8 % of a compilation. Intermediate code is half of what numba would write
(`asperity.kernels.lowering`).

What numba would keep are pickles, and machine code that is run as it is. So only files are read that are
as they were written, by their seal, in a folder that nobody but the user can write to; a file is named by all
that it depends on. What is damaged, incomplete or of another version counts as missing, and is compiled anew.

For this `_nrt`, `forceinline`, the options without entries, `_cache` of a kernel, the parts of a
compilation, its passes, the types of calls and the steps of a library are needed, which numba does not
document. They are tested with numba 0.60 to 0.68: the oldest that is allowed and the newest there is. Where
one is missing plain `numba.njit` serves, which a warning says.
"""

import gc
import hashlib
import operator
import pickle
import re
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from numba import njit

from asperity.files import is_sealed, replace
from asperity.progress import COMPILATION
from asperity.store import KERNELS, is_private, kernel_folders

LOOP: dict[str, Any] = {"cache": True, "_nrt": False}
"""For what Python calls, as a loop over time steps; it is kept on disk with all that it calls."""
INNER: dict[str, Any] = {"_nrt": False, "forceinline": True, "no_cpython_wrapper": True}
"""For what only kernels call, or rarely Python, for which it is compiled once more."""
CALLED: dict[str, Any] = {"_nrt": False, "no_cpython_wrapper": True}
"""Likewise, for what takes long to compile or is called in several places of a kernel."""
ONCE: dict[str, Any] = {"_nrt": False, "inline": "always"}
"""For what is called in one place and contains much: it is compiled there, not before and there again.

What Python calls of it is kept on disk, too.
"""
REASSOCIATE: dict[str, Any] = {"fastmath": {"reassoc", "contract", "nsz"}}
"""Lets sums over poles be vectorised; NaN stays NaN."""
CONTRACT: dict[str, Any] = {"fastmath": {"contract"}}
"""Lets a product and a sum become one instruction, and leaves their order as it is written."""
UNCHECKED: dict[str, Any] = {"error_model": "numpy"}
"""Divides without a look at the divisor: nothing leaves a loop then, which may become one of vectors."""
DOCUMENTED = ("error_model", "fastmath", "inline", "nogil")
HIDDEN = ("_nrt", "forceinline", "no_cpython_wrapper", "no_cfunc_wrapper")
STEPS = ("_optimize_final_module", "_finalize_final_module")
NEEDLESS = {
    "WithLifting", "InlineClosureLikes", "RewriteDynamicRaises", "MakeFunctionToJitFunction",
    "FindLiterallyCalls", "LiteralUnroll", "LiteralPropagationSubPipelinePass", "InlineOverloads",
    "NopythonRewrites", "NoPythonSupportedFeatureValidation", "AnnotateTypes", "DumpParforDiagnostics",
}  # fmt: skip
"""Passes over closures, ``with``, ``raise`` with values, literals, array expressions and what people read."""
OPERATORS = {each for each in vars(operator).values() if callable(each)}


try:
    from numba.core.caching import NullCache
    from numba.core.codegen import JITCodeLibrary
    from numba.core.compiler import Compiler, CompileResult
    from numba.core.cpu import CPUTargetOptions
    from numba.core.lowering import Lower
    from numba.core.registry import CPUDispatcher
    from numba.core.runtime.nrt import rtsys
    from numba.core.serialize import dumps
    from numba.core.typed_passes import NativeLowering
    from numba.core.types import Boolean, Number
    from numba.core.types.functions import BaseFunction

    from asperity.kernels.lowering import NEEDED, LeanLowering

    PLAIN = not all(
        [hasattr(CPUTargetOptions, name) for name in HIDDEN]
        + [hasattr(CompileResult, name) for name in ("_reduce", "_rebuild")]
        + [hasattr(JITCodeLibrary, name) for name in STEPS]
        + [hasattr(Lower, name) for name in NEEDED]
        + ["get_call_type" in vars(BaseFunction), hasattr(Compiler, "define_pipelines")]
    )
except ImportError:
    CPUDispatcher = NullCache = Compiler = JITCodeLibrary = object  # type: ignore[assignment,misc]
    PLAIN = True
else:
    FIND_TYPE: Any = getattr(BaseFunction, "get_call_type", None)
if PLAIN:
    warnings.warn(
        f"numba {version('numba')} lacks what asperity needs to keep compiled functions: every start "
        "compiles them again, and they are slower. Install numba 0.60 to 0.68.",
        RuntimeWarning,
        stacklevel=2,
    )


@contextmanager
def _garbage_left() -> Iterator[None]:
    """Let Python look for no garbage meanwhile."""
    looking = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if looking:
            gc.enable()


@contextmanager
def _collected_in(kind: type, codegen: Any) -> Iterator[None]:
    """Let numba collect code in libraries of a kind meanwhile, that of its own functions, too."""
    before = codegen._library_class
    codegen._library_class = kind
    try:
        yield
    finally:
        codegen._library_class = before


_typed: dict[tuple[Any, tuple[Any, ...]], Any] = {}  # operators on types of numbers


def _type_once(function: Any, context: Any, types: tuple[Any, ...], named: dict[str, Any]) -> Any:
    """What numba finds that a call gives, of an operator on numbers only once."""
    asked = (function.typing_key, types)
    if asked in _typed:
        return _typed[asked]
    found = FIND_TYPE(function, context, types, named)
    if asked[0] in OPERATORS and all(isinstance(each, (Number, Boolean)) for each in types):
        _typed[asked] = found
    return found


@contextmanager
def _operators_typed_once() -> Iterator[None]:
    """Let numba not look for the type of an operator again wherever it stands."""
    before = BaseFunction.get_call_type
    BaseFunction.get_call_type = _type_once  # type: ignore[method-assign,assignment]
    try:
        yield
    finally:
        BaseFunction.get_call_type = before  # type: ignore[method-assign]


class _Compiler(Compiler):
    """Numba's compiler, of a kernel with an entry."""

    def define_pipelines(self) -> Any:
        """What numba does, without what no kernel needs, and with less intermediate code."""
        managers = super().define_pipelines()
        for each in managers:
            each.passes = [
                (LeanLowering if done is NativeLowering else done, what)
                for done, what in each.passes
                if done.__name__ not in NEEDLESS
            ]
        return managers

    def compile_extra(self, function: Callable[..., Any]) -> Any:
        """Compile a function, and of all that it calls no more than it needs."""
        codegen = self.state.targetctx.codegen()
        self.state.library = self._library(codegen, function.__qualname__)
        with _garbage_left(), _operators_typed_once(), _collected_in(_Part, codegen):
            return super().compile_extra(function)

    def _library(self, codegen: Any, name: str) -> Any:
        """What the code is collected in."""
        library = JITCodeLibrary(codegen, name)
        library.enable_object_caching()
        return library


class _InnerCompiler(_Compiler):
    """That of a kernel without one."""

    def _library(self, codegen: Any, name: str) -> Any:
        return _Part(codegen, name)


class _Part(JITCodeLibrary):
    """Code that is part of other code, where it is optimised and made machine code."""

    class codegen:
        """What numba hands the environment of machine code to: here is none."""

        set_env = staticmethod(lambda *_: None)

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalized = True


class _Inner(CPUDispatcher):
    """A kernel without an entry from Python: often this takes the compiler longer than the kernel itself."""

    def __call__(self, *arguments: Any) -> Any:
        """Call it from Python: compiled once more, with an entry."""
        if not hasattr(self, "_entered"):
            kept = {*DOCUMENTED, "_nrt"} - {"inline"}
            options = {k: v for k, v in self.targetoptions.items() if k in kept}
            self._entered = compiled(**options, cache=True)(self.py_func)
        return self._entered(*arguments)


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Compile a kernel as `numba.njit` does; with ``cache`` it is kept until any kernel's source changes."""
    keep = options.pop("cache", False)
    if PLAIN:
        return njit(**{name: value for name, value in options.items() if name in DOCUMENTED})

    def decorate(function: Callable[..., Any]) -> Any:
        inner = "no_cpython_wrapper" in options
        using = _InnerCompiler if inner else _Compiler
        kernel: Any = njit(**options | {"no_cfunc_wrapper": True}, pipeline_class=using)(function)
        if inner or options.get("inline") == "always":
            kernel.__class__ = _Inner
        if keep:
            kernel._cache = Kept(function)  # what ``cache=True`` would set
        return kernel

    return decorate


_parts = [f"{version('numba')} {version('llvmlite')} {sys.version}".encode()]
_parts += [
    each.read_bytes() for end in ("py", "toml") for each in sorted(Path(__file__).parent.glob(f"*.{end}"))
]
SOURCES = hashlib.sha256(b"".join(_parts)).hexdigest()[:16]
"""Folder of these kernels: named by what they are made of, as one is compiled into another."""


def is_kept(kernel: str) -> bool:
    """Whether machine code of a kernel lies in one of the folders."""
    with suppress(OSError):
        return any(any((folder / SOURCES).glob(f"{kernel}-*")) for folder in kernel_folders())
    return False


class Kept(NullCache):
    """What numba asks for the machine code of a function, and hands it to, signature by signature.

    Stands for `numba.core.caching.FunctionCache`, which trusts what it finds and fails where it cannot write.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self.name = re.sub(r"[^\w.]", "", f"{function.__module__}.{function.__qualname__}")
        own = Path(function.__code__.co_filename)
        self.source = own.read_bytes() if own.is_file() else b""

    @property
    def cache_path(self) -> str:
        """The first of the folders."""
        return str(next(kernel_folders(), ""))

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Load the machine code of a signature; None if it has to be compiled."""
        name = self.file_name(signature, context.codegen())
        for folder in kernel_folders():
            data = _read(folder / SOURCES, name)
            if data is not None:
                rtsys.initialize(context)  # what machine code calls
                with _collected_in(JITCodeLibrary, context.codegen()):  # even while another is compiled
                    return CompileResult._rebuild(context, *data)
        COMPILATION.begin(name)
        return None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep the machine code of a signature, in the first folder that takes it."""
        name = self.file_name(signature, result.codegen)
        COMPILATION.end(name)
        if result.lifted or result.library.has_dynamic_globals:  # holds objects or addresses of this process
            return
        bare = result._replace(type_annotation="")  # types beside each line of the source, for people
        payload = dumps((name, bare._reduce()))
        if not any(_written(folder / SOURCES, name, payload) for folder in kernel_folders()):
            _warn_unkept()

    def file_name(self, signature: Any, codegen: Any) -> str:
        """Name of a signature's file: the function's name, and a digest of all that the code depends on."""
        known = repr((self.name, str(signature), codegen.magic_tuple())).encode()
        return f"{self.name}-{hashlib.sha256(known + self.source).hexdigest()[:24]}"


def _read(folder: Path, name: str) -> Any:
    """Read what a file holds; None if there is none, or none that can be trusted."""
    if not (is_private(folder) and (folder / name).is_file()):  # a pipe might never end
        return None
    with suppress(OSError), open(folder / name, "rb") as file:
        if is_sealed(file):
            kept_name, data = pickle.load(file)  # noqa: S301 (our own, see above)
            return data if kept_name == name else None
    return None


def _written(folder: Path, name: str, payload: bytes) -> bool:
    """Write a file completely or not at all; return whether it is there."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not is_private(folder):
            return False
        replace(folder / name, lambda file: file.write(payload), sealed=True, lasting=False)
    except OSError:
        return False
    return True


@cache
def _warn_unkept() -> None:
    """Warn, once."""
    tried = " or ".join(str(folder) for folder in kernel_folders()) or "any folder"
    warnings.warn(
        f"compiled functions cannot be kept in {tried}: every start compiles them again, some 10 s. Let "
        f"${KERNELS} name a folder that you alone can write to.",
        RuntimeWarning,
        stacklevel=2,
    )
