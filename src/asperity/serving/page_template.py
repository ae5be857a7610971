"""The page as HTML, with the forms of all kinds of case in it."""

from __future__ import annotations

from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined

from asperity import __version__
from asperity.files import amount
from asperity.serving.case_form import forms
from asperity.serving.uploads import LARGEST_UPLOAD

SLIDERS = (("Roughness", "surface.rms surface.level"), ("Load", ".load"), ("Speed", "speed"))
"""What is turned most, and ends of the keys that do it: the first of them that holds a number."""


@cache
def page_text() -> str:
    """Write the page; what it shows of runs and contacts its script asks for."""
    environment = Environment(
        loader=PackageLoader("asperity.serving", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("page.html.jinja").render(
        forms=forms(),
        sliders=SLIDERS,
        version=__version__,
        largest=LARGEST_UPLOAD,
        largest_words=amount(LARGEST_UPLOAD),
    )
