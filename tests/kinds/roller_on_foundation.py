"""A roller on an elastic foundation: a kind of case in one file, as a user would write it.

The foundation is massless: w = F/k. The roller is a rigid mass under a load.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import BeforeValidator

from asperity.config.case import Case, Law
from asperity.config.chosen import NominalPatch
from asperity.config.form import Section, key
from asperity.config.sections import ContactCase, Numerics
from asperity.config.values import Choice, Force, Length, Mass, OwnOrNamed, Stiffness
from asperity.contact import Hertz
from asperity.reference.materials import contact_modulus
from asperity.scenarios.geometry import geometry, parabola
from asperity.scenarios.kind import Words
from asperity.scenarios.scene import Scene
from asperity.structures.body import Body
from asperity.structures.modal import STATIC, STATIC_DAMPING


class Roller(Section):
    """What rolls."""

    radius: Length = key("25 mm", "radius", "10 um to 10 m: rollers lie between")
    mass: Mass = key("0.5 kg", "mass", "1 mg to 1000 t: rollers lie between")
    load: Force = key("30 N", "force that presses it down", "1 nN to 1 GN: loads lie between")
    material: OwnOrNamed = key("steel", "material")


class Foundation(Section):
    """What is rolled over."""

    stiffness: Stiffness = key("5 MN/m", "stiffness", "1 N/m to 1 TN/m: foundations lie between")
    material: OwnOrNamed = key("steel", "material of its surface")


class RollerOnFoundation(Case):
    """A roller on an elastic foundation."""

    kind: Annotated[str, BeforeValidator(Choice(("roller-on-foundation",)))] = key(
        "roller-on-foundation", "what rolls"
    )
    laws: tuple[Law, ...] = key(("areal", "hertz", "linear"), "laws of the contact force")
    roller: Roller = key({}, "the roller")
    foundation: Foundation = key({}, "the foundation")
    contact: ContactCase = key({}, "how the rough contact is solved and reduced")
    numerics: Numerics = key({}, "how finely time is resolved")

    @property
    def nominal_patch(self):
        """Contact from which grid and window are chosen."""
        roller = self.roller
        modulus = contact_modulus(roller.material, self.foundation.material)
        return NominalPatch.of(modulus, roller.radius, roller.radius, roller.load)


CASE = RollerOnFoundation
ROLLING = "roller"
WORDS = Words("A roller on an elastic foundation.", " in [surface]", {"surface.rms": '"0.2 um"'})


@dataclass(frozen=True)
class ElasticFoundation:
    """A massless foundation of a stiffness, N/m: one mode that answers at once, the same everywhere."""

    stiffness: float

    extent = (0.0, 1e6)
    natural_frequencies = np.array([STATIC])
    damping_ratios = np.array([STATIC_DAMPING])

    def shapes(self, x):
        """φ = ω/√k, so that φ²/ω² is the compliance 1/k; and its slope."""
        shape = 2.0 * np.pi * STATIC / np.sqrt(self.stiffness)
        return np.full((np.size(x), 1), shape), np.zeros((np.size(x), 1))

    def shapes_along(self, start, spacing, count):
        """At equally spaced positions."""
        return self.shapes(np.zeros(count))


def bodies_of(case):
    """Build the scene of a case."""
    roller = Body.rigid(case.roller.mass, case.roller.load)
    return Scene(ElasticFoundation(case.foundation.stiffness), (roller,), "A roller on an elastic foundation")


def geometry_of(case):
    """Lay out the roller on the contact grid."""
    modulus = contact_modulus(case.roller.material, case.foundation.material)
    hertz = Hertz(modulus, case.roller.radius, case.roller.radius)
    section = parabola(case.contact, case.roller.radius)
    return geometry(
        case.contact,
        section,
        hertz,
        case.roller.load,
        smallest_radius=case.roller.radius,
        body="roller",
    )
