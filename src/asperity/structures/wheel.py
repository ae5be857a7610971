"""The wheel: a mass under a constant load, rigid or with resonances."""

from dataclasses import dataclass, field

import numpy as np

from asperity.arguments import Array, ArrayLike, Complex, positive
from asperity.errors import InputError
from asperity.structures import modal
from asperity.structures.body import Body, no_modes, resonances


@dataclass(frozen=True, eq=False)
class Wheel:
    """Wheel at its contact point, in the vertical direction: a free mass and flexible modes.

    Parameters
    ----------
    mass : float
        M, unsprung mass per wheel, kg: that of its rigid motion. Its suspension is soft: the wheel counts as
        free.
    load : float
        Static contact force, weight included, N.
    natural_frequencies : array_like (p,), optional
        Of the flexible modes, undamped, Hz.
    damping_ratios : array_like (p,), optional
        ζ, share of critical damping, above 0 and below 1.
    modal_masses : array_like (p,), optional
        m, with the vertical mode shape at the contact point scaled to one, kg.

    Raises
    ------
    InputError
        If mass or load is not positive, or the lists differ in length or hold values out of range.

    Notes
    -----
    The modes are those that the contact feels. A wheel that turns splits each mode with nodal diameters in
    two: `asperity.structures.wheel_modes.WheelModes.turning`.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity import Wheel
    >>> wheel = Wheel(mass=600.0, load=65e3)
    >>> omega = 2 * np.pi * 100.0
    >>> bool(np.isclose(abs(wheel.receptance(np.array([100.0])))[0], 1 / (600.0 * omega**2)))
    True
    """

    mass: float
    load: float
    natural_frequencies: Array = field(default_factory=no_modes)
    damping_ratios: Array = field(default_factory=no_modes)
    modal_masses: Array = field(default_factory=no_modes)

    def __post_init__(self) -> None:
        positive("wheel mass (kg)", self.mass)
        positive("wheel load (N)", self.load)
        names = ("natural_frequencies", "damping_ratios", "modal_masses")
        for name, values in zip(names, resonances(*(getattr(self, name) for name in names)), strict=True):
            object.__setattr__(self, name, values)

    @property
    def body(self) -> Body:
        """The same as a body on one contact."""
        modes = self.natural_frequencies, self.damping_ratios, self.modal_masses
        return Body.rigid(self.mass, self.load).with_modes(*modes)

    def receptance(self, frequency: ArrayLike) -> Complex:
        """Displacement per harmonic force at the contact point.

        Parameters
        ----------
        frequency : array_like
            Hz, above zero.

        Returns
        -------
        ndarray of complex
            −1/(Mω²) + Σ 1/(m (ω₀² − ω² + 2iζω₀ω)), m/N, of the shape of `frequency`; e^{+iωt}.

        Raises
        ------
        InputError
            If a frequency is not above zero.
        """
        f = np.asarray(frequency, dtype=float)
        if not (f > 0.0).all():
            allowed = "above 0: a free wheel has no static receptance"
            raise InputError("frequency (Hz)", float(np.min(f)), allowed)
        modes = modal.modal_answers(f, self.natural_frequencies, self.damping_ratios)
        return np.asarray(modes @ (1.0 / self.modal_masses) - 1.0 / (self.mass * (2.0 * np.pi * f) ** 2))
