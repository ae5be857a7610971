"""What roughness does when things roll: rough 3-D contact, reduced, rolled and heard."""

import importlib
from typing import Any

__version__ = "0.1.0"

_HOME = {
    "ArchardWear": "contact.wear",
    "BallBearing": "structures.ball_bearing",
    "Beam": "structures.beam",
    "Contact": "contact.solved",
    "Crowning": "contact.crowning",
    "EnergyWear": "contact.wear",
    "Friction": "contact.friction",
    "FrictionalHalfSpace": "contact.tangential",
    "HalfSpace": "contact.halfspace",
    "HeightMap": "surfaces.heightmap",
    "Hertz": "contact.hertz",
    "FourPointBall": "contact.gothic_arch",
    "GothicArch": "contact.gothic_arch",
    "LineContact": "contact.line",
    "Measured": "observables.observable",
    "Material": "reference.materials",
    "ModalStructure": "structures.modal",
    "Profile": "surfaces.heightmap",
    "RollerBearing": "structures.roller_bearing",
    "SlicedContact": "contact.slices",
    "SlidingContact": "contact.friction",
    "Support": "structures.beam",
    "SupportedBeam": "structures.beam",
    "Track": "structures.track",
    "Wheel": "structures.body",
    "WheelSection": "structures.outline",
    "compare": "scenes.report",
    "effects": "studies.effects",
    "fit": "fitting.running",
    "listen": "reporting.sound",
    "material": "reference.materials",
    "open_result": "running",
    "optimise": "optimising.running",
    "prediction_band": "studies.ensemble",
    "read_case": "case.cases",
    "read_modal_structure": "structures.modal_files",
    "read_surface": "surfaces.readers",
    "report": "scenes.report",
    "run": "running",
    "save": "results",
    "study": "studies.running",
    "wear_depth": "contact.wear",
    "wheel_modes": "structures.wheel_modes",
    "what_helps": "studies.effects",
    "worn": "contact.wear",
    "write_signals": "reporting.signal_files",
}
"""Module of each public name; the cases of each kind come beside them."""

_MODULES = {
    "diagnostics": "diagnostics",
    "errors": "errors",
    "laws": "laws",
    "rolling": "rolling",
    "synthesis": "surfaces.synthesis",
}
"""Public modules, by the names that they have here."""


_RENAMED = {"BallBearingCase": "BearingUnderLoad"}
"""Names that scripts may still use, and what they are now."""


def _cases() -> dict[str, str]:
    """Kinds of case by the classes of their cases."""
    known = importlib.import_module("asperity.case").kinds()
    return {place.rpartition(".")[2]: kind for kind, place in known.items()}


def __getattr__(name: str) -> Any:
    """Import a public name on first use, so that ``import asperity`` stays fast."""
    name = _RENAMED.get(name, name)
    if name == "__all__":
        return ["__version__", *_HOME, *_MODULES, *_cases()]
    if name in _MODULES:
        return importlib.import_module(f"asperity.{_MODULES[name]}")
    if name in _HOME:
        return getattr(importlib.import_module(f"asperity.{_HOME[name]}"), name)
    if name.startswith("_") or name not in (cases := _cases()):
        raise AttributeError(f"module 'asperity' has no attribute {name!r}")
    return importlib.import_module("asperity.case.cases").case_class(cases[name])


def __dir__() -> list[str]:
    return sorted(["__version__", *_HOME, *_MODULES, *_cases()])
