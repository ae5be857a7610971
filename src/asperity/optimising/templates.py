"""Commented aims of optimisations, by the words of ``asperity new``."""

from collections.abc import Callable, Mapping

from asperity.optimising.bearing import bearing_aim_template
from asperity.optimising.definition import aim_template

AIM_TEMPLATES: Mapping[str, Callable[[], str]] = {
    "optimisation": aim_template,
    "optimisation-of-bearings": bearing_aim_template,
}
