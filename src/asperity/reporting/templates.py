"""Templates of pages, which know no results: what shows none need not import what reads them."""

from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined, Template

from asperity.written_numbers import unbroken


@cache
def page_template(name: str, package: str = "asperity.reporting") -> Template:
    """A template of a package, which writes text of others so that it is seen and does nothing."""
    environment = Environment(
        loader=PackageLoader(package, ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["unbroken"] = unbroken
    return environment.get_template(name)
