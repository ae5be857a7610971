"""A roller on an elastic foundation: a scene, with a structure of its own, in one file of a user.

The foundation is massless: w = F/k. The roller is what rolls in any scene, with other defaults.
"""

from dataclasses import dataclass

import numpy as np

from asperity.case.body import Rolling
from asperity.case.form import section
from asperity.case.rolled_over import RolledOver
from asperity.case.scene import Case
from asperity.parameters import STIFFNESS, Choice, MaterialOrName, key
from asperity.reference.materials import Material
from asperity.structures.modal import STATIC, STATIC_DAMPING


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


class Foundation(RolledOver):
    """What is rolled over, endless."""

    stiffness: float = key(STIFFNESS, "5 MN/m", "stiffness", "1 N/m to 1 TN/m: foundations lie between")
    material: Material = key(MaterialOrName(), "steel", "material of its surface")

    @property
    def helping_changes(self):
        """What a study of what helps asks of it."""
        return {"half as stiff": {"foundation": {"stiffness": "times 0.5"}}}

    def model(self, highest_frequency):
        """Build it."""
        return ElasticFoundation(self.stiffness)


DEFAULTS = {"laws": ["areal", "hertz", "linear"]}


class RollerOnFoundation(Case, defaults=DEFAULTS):
    """A roller on an elastic foundation."""

    TITLE = "A roller on an elastic foundation."
    ROLLING, OVER = "roller", "foundation"

    kind: str = key(Choice(("roller-on-foundation",)), "roller-on-foundation", "what rolls")
    roller: Rolling = section(Rolling, "the roller", mass="0.5 kg", load="30 N")
    foundation: Foundation = section(Foundation, "what is rolled over")
