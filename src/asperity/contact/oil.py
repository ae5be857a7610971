"""An oil: its viscosity over temperature and pressure, by grade and viscosity index or by two viscosities."""

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Self

import numpy as np

from asperity.arguments import positive, real, require
from asperity.written_numbers import rounded

GRADES = (2, 3, 5, 7, 10, 15, 22, 32, 46, 68, 100, 150, 220, 320, 460, 680, 1000, 1500, 2200, 3200)
"""ISO 3448: mm²/s at 40 °C in the middle of each grade, which is 10 % wide to either side."""
INDEX = 95.0
"""Viscosity index of a usual mineral oil, chosen here."""
DENSITY = 870.0
"""Of a usual mineral oil, kg/m³, chosen here: it falls by some 0.7 kg/m³ with each kelvin."""
CONDUCTIVITY = 0.14
"""Thermal conductivity of a usual mineral oil, W/(m K), chosen here."""
KELVIN = 273.15
COOL, HOT = 40.0, 100.0
"""°C, at which viscosities are printed."""
WALTHER = 0.7
"""mm²/s, added before the logarithms (ASTM D341, above 2 mm²/s)."""
STANDARD_OILS: list[list[float]] = np.loadtxt(
    Path(__file__).with_name("standard_oils.txt"), encoding="utf-8"
).tolist()
"""ASTM D2270, Table X2.1: from which mm²/s at 100 °C on; L = a y² + b y + c and H = d y² + e y + f, mm²/s at
40 °C, of oils of index 0 and 100 that have y at 100 °C."""
THINNEST = 2.0
"""mm²/s at 100 °C below which the index is not defined."""
REFERENCE_PRESSURE = 196.2e6
"""Pa: Roelands' 1/5.1e-9."""
POLE = 9.67
"""Minus the logarithm of 6.31e-5 Pa s, a viscosity to which Roelands' isotherms run together."""


@dataclass(frozen=True)
class Oil:
    """Newtonian oil between two temperatures at which its viscosity is known.

    Parameters
    ----------
    viscosity_40, viscosity_100 : float
        Kinematic, at 40 and at 100 °C, m²/s.
    density : float
        kg/m³, taken as that at all temperatures.
    pressure_viscosity : float, optional
        α of Barus' η = η₀ exp(α p), 1/Pa, at the temperature at which it is used; by default from both
        viscosities, `Oil.pressure_viscosity_at`.
    conductivity : float
        Thermal, W/(m K).

    Raises
    ------
    InputError
        If a number is not positive, or the oil is not thinner when it is hot.

    Notes
    -----
    lg lg (ν/(mm²/s) + 0.7) is straight over lg T: Walther's equation, ASTM D341.

    Examples
    --------
    >>> from asperity.contact.oil import Oil
    >>> oil = Oil.of_grade(68, index=95)
    >>> f"{oil.viscosity_100 * 1e6:.2f} mm²/s at 100 °C, {oil.viscosity(70.0) * 1e3:.1f} mPa s at 70 °C"
    '8.53 mm²/s at 100 °C, 17.3 mPa s at 70 °C'
    """

    viscosity_40: float
    viscosity_100: float
    density: float = DENSITY
    pressure_viscosity: float | None = None
    conductivity: float = CONDUCTIVITY

    def __post_init__(self) -> None:
        for name in ("viscosity_40", "viscosity_100", "density", "conductivity"):
            positive(f"{name} of the oil", getattr(self, name))
        if self.pressure_viscosity is not None:
            positive("pressure_viscosity of the oil (1/Pa)", self.pressure_viscosity)
        received = f"{rounded(1e6 * self.viscosity_100)} mm²/s"
        allowed = f"more than {1.0 - WALTHER:.1f} mm²/s, where Walther's equation ends"
        thick = 1e6 * self.viscosity_100 > 1.0 - WALTHER
        require(thick, "viscosity of the oil at 100 °C", received, allowed)
        allowed = f"less than at 40 °C, {rounded(1e6 * self.viscosity_40)} mm²/s"
        require(self.viscosity_100 < self.viscosity_40, "viscosity of the oil at 100 °C", received, allowed)

    @classmethod
    def of_grade(cls, grade: int, index: float = INDEX) -> Self:
        """Oil of an ISO viscosity grade (ISO 3448) and a viscosity index (ASTM D2270).

        Parameters
        ----------
        grade : int
            mm²/s at 40 °C.
        index : float
            0 to 300.

        Returns
        -------
        Oil
            With the middle of its grade at 40 °C, and at 100 °C what gives the index.

        Raises
        ------
        InputError
            For a grade or an index that there is not, or an oil too thin to have one.
        """
        told = ", ".join(map(str, GRADES))
        require(grade in GRADES, "ISO viscosity grade", grade, told, "Or give both viscosities.")
        real("viscosity index", index, "0 to 300", at_least=0.0, at_most=300.0)
        received = f"{index:g} of an oil of {grade} mm²/s at 40 °C"
        allowed = f"that of an oil of {THINNEST:g} mm²/s or more at 100 °C"
        remedy = "Give both viscosities instead."
        thick = index >= viscosity_index(float(grade), THINNEST)
        require(thick, "viscosity index", received, allowed, remedy)
        low = THINNEST
        high = float(grade)
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if viscosity_index(float(grade), middle) < index else (low, middle)
        return cls(1e-6 * grade, 1e-6 * high)

    @property
    def index(self) -> float:
        """Its viscosity index (ASTM D2270); NaN where it is too thin to have one."""
        thin = 1e6 * self.viscosity_100 < THINNEST
        return math.nan if thin else viscosity_index(1e6 * self.viscosity_40, 1e6 * self.viscosity_100)

    @cached_property
    def _walther(self) -> tuple[float, float]:
        """A and B of lg lg (ν + 0.7) = A − B lg T, T in K."""
        cool, hot = (_doubly(1e6 * each) for each in (self.viscosity_40, self.viscosity_100))
        at = [math.log10(each + KELVIN) for each in (COOL, HOT)]
        slope = (cool - hot) / (at[1] - at[0])
        return cool + slope * at[0], slope

    def kinematic_viscosity(self, temperature: float) -> float:
        """Kinematic viscosity at a temperature, °C, and no pressure, m²/s."""
        constant, slope = self._walther
        kelvin = real("temperature (°C)", temperature, "above -100", above=-100.0) + KELVIN
        return 1e-6 * (10.0**10.0 ** (constant - slope * math.log10(kelvin)) - WALTHER)

    def viscosity(self, temperature: float) -> float:
        """Dynamic viscosity η₀ at a temperature, °C, and no pressure, Pa s."""
        return self.density * self.kinematic_viscosity(temperature)

    def thinning(self, temperature: float) -> float:
        """Share by which the viscosity falls with each kelvin at a temperature, °C: −d ln η/dT, 1/K."""
        constant, slope = self._walther
        kelvin = temperature + KELVIN
        inner = 10.0 ** (constant - slope * math.log10(kelvin))  # lg (ν + 0.7)
        shifted = 10.0**inner
        return shifted / (shifted - WALTHER) * math.log(10.0) * inner * slope / kelvin

    def pressure_viscosity_at(self, temperature: float) -> float:
        """Pressure-viscosity coefficient at a temperature, °C, 1/Pa; Z (ln η₀ + 9.67)/196.2 MPa if not given.

        Notes
        -----
        Roelands' index of mineral oils follows from their viscosities at 40 and 100 °C, mPa s:
        Z = (7.81 (H₄₀ − H₁₀₀))^1.5 F₄₀, H = lg (lg η + 1.2), F₄₀ = 0.885 − 0.864 H₄₀. R. S. Fein, in CRC
        Handbook of Lubrication and Tribology III (1994); H. Nguyen-Schäfer, Computational Tapered and
        Cylinder Roller Bearings (2019), 1.8.
        """
        if self.pressure_viscosity is not None:
            return self.pressure_viscosity
        return self.roelands_index / REFERENCE_PRESSURE * (math.log(self.viscosity(temperature)) + POLE)

    @property
    def roelands_index(self) -> float:
        """Roelands' pressure-viscosity index Z of a mineral oil, from both viscosities; about 0.6."""
        cool, hot = (
            math.log10(math.log10(1e3 * self.density * each) + 1.2)
            for each in (self.viscosity_40, self.viscosity_100)
        )
        return (7.81 * (cool - hot)) ** 1.5 * (0.885 - 0.864 * cool)

    def barus(self, temperature: float, pressure: float) -> float:
        """Viscosity under a pressure, Pa, by Barus: η₀ exp(α p), Pa s; far too large above some 0.5 GPa."""
        return self.viscosity(temperature) * math.exp(self.pressure_viscosity_at(temperature) * pressure)

    def roelands(self, temperature: float, pressure: float) -> float:
        """Viscosity under a pressure, Pa, by Roelands: η₀ exp((ln η₀ + 9.67)((1 + p/196.2 MPa)^Z − 1)), Pa s.

        Z is that which has the slope α without pressure.
        """
        viscosity = self.viscosity(temperature)
        height = math.log(viscosity) + POLE
        index = self.pressure_viscosity_at(temperature) * REFERENCE_PRESSURE / height
        return viscosity * math.exp(height * ((1.0 + pressure / REFERENCE_PRESSURE) ** index - 1.0))


def _doubly(viscosity: float) -> float:
    """lg lg (ν + 0.7) of a viscosity, mm²/s."""
    return math.log10(math.log10(viscosity + WALTHER))


def viscosity_index(viscosity_40: float, viscosity_100: float) -> float:
    """Viscosity index of an oil by its kinematic viscosities at 40 and 100 °C, mm²/s.

    Notes
    -----
    ASTM D2270, with the equations of its appendix for the oils of index 0 and 100: 100 (L − U)/(L − H), and
    above 100 it is 100 + (10^N − 1)/0.00715, N = (lg H − lg U)/lg Y.
    """
    allowed = f"{THINNEST:g} or more"
    hot = real("viscosity at 100 °C (mm²/s)", viscosity_100, allowed, at_least=THINNEST)
    *_, row = (each for each in STANDARD_OILS if hot >= each[0])
    worst, best = (c[0] * hot**2 + c[1] * hot + c[2] for c in (row[1:4], row[4:7]))
    if viscosity_40 >= best:
        return 100.0 * (worst - viscosity_40) / (worst - best)
    power = (math.log10(best) - math.log10(viscosity_40)) / math.log10(hot)
    return 100.0 + (10.0**power - 1.0) / 0.00715
