"""Named elastic materials, each with its source."""

import math
from dataclasses import dataclass

from asperity.arguments import one_of, positive, real, require
from asperity.written_numbers import rounded

FASTEST_SOUND = 36e3
"""m/s, that sound exceeds in no solid (Trachenko et al., Sci. Adv. 6 (2020) eabc8662); in diamond, half."""


@dataclass(frozen=True)
class Material:
    """Isotropic elastic material.

    Parameters
    ----------
    name : str
        What it is called.
    youngs_modulus : float
        E, Pa.
    poisson_ratio : float
        nu, between -1 and 0.5.
    density : float
        kg/m^3.
    citation : str
        Where the values come from.

    Raises
    ------
    InputError
        If a value is outside what an elastic solid can have.

    Examples
    --------
    >>> from asperity import Material
    >>> brass = Material("brass", youngs_modulus=100e9, poisson_ratio=0.34, density=8500.0)
    >>> brass.density
    8500.0
    """

    name: str
    youngs_modulus: float
    poisson_ratio: float
    density: float
    citation: str = ""

    def __post_init__(self) -> None:
        positive(f"Young's modulus (Pa) of {self.name}", self.youngs_modulus)
        positive(f"density (kg/m^3) of {self.name}", self.density)
        what = f"Poisson's ratio of {self.name}"
        allowed = "above -1, at most 0.5"
        real(what, self.poisson_ratio, allowed, above=-1.0, at_most=0.5)


def solid(material: Material) -> Material:
    """Return a material that a solid can have; a rigid one, as scripts compute with, is none."""
    sound = math.sqrt(material.youngs_modulus / material.density)
    what = f"Young's modulus over density of {material.name}"
    received = f"values by which sound runs along a bar at {rounded(sound)} m/s"
    allowed = f"at most {FASTEST_SOUND:g} m/s, as in any solid"
    remedy = 'Are both units right? Steel has "210 GPa" and "7850 kg/m^3".'
    require(sound <= FASTEST_SOUND, what, received, allowed, remedy)
    return material


MATERIALS: dict[str, Material] = {
    material.name: material
    for material in (
        Material("steel", 210e9, 0.3, 7850.0, "EN 1993-1-1:2005, 3.2.6; density EN 1991-1-1:2002, table A.4"),
        Material("aluminium", 70e9, 0.3, 2700.0, "EN 1999-1-1:2007, 3.2.5"),
        Material("glass", 70e9, 0.2, 2500.0, "soda-lime silicate glass, EN 572-1:2012, table 1"),
        Material(
            "silicon nitride",
            310e9,
            0.27,
            3200.0,
            "typical of bearing grades; ASTM F2094 asks for 270-330 GPa, 0.23-0.29, 3.0-3.4 g/cm^3",
        ),
        Material(
            "tungsten carbide",
            630e9,
            0.22,
            14900.0,
            "typical of cemented carbide with 6 % cobalt; makers state 600-650 GPa",
        ),
    )
}


def material(name: str) -> Material:
    """Look a material up by its name.

    Parameters
    ----------
    name : str
        As in `MATERIALS`; capitals do not matter.

    Returns
    -------
    Material
        The material.

    Raises
    ------
    InputError
        If there is none of that name; the nearest is named.

    Examples
    --------
    >>> from asperity import material
    >>> material("Steel").youngs_modulus
    210000000000.0
    """
    return MATERIALS[one_of("material", name.strip().lower(), MATERIALS)]


def contact_modulus(first: Material, second: Material) -> float:
    """Contact modulus E* of two bodies.

    Parameters
    ----------
    first, second : Material
        The bodies.

    Returns
    -------
    float
        E*, Pa: 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 (Johnson, Contact Mechanics, 1985).
    """
    compliance = sum((1.0 - m.poisson_ratio**2) / m.youngs_modulus for m in (first, second))
    return 1.0 / compliance
