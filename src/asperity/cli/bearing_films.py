"""``asperity bearing --oil``: how thick films of oil are under the heaviest loads."""

from typing import Any

from asperity.case.loaded_bearing import LoadKeys
from asperity.contact.film import FULL
from asperity.terminal import say, say_table
from asperity.written_numbers import rounded

RINGS = ("inner", "outer")
WIDTH = 122


def say_films(keys: LoadKeys, found: Any) -> list[dict[str, Any]] | None:
    """Print the films on both rings, and return their numbers; nothing without oil."""
    if (oil := keys.lubricant.found) is None:
        return None
    assert keys.speed
    of = found.bearing
    turning = of.kinematics(keys.speed, contact_angle=found.contact_angle)
    told: list[dict[str, Any]] = []
    rows = []
    for ring, contact, speed, loads in zip(
        RINGS,
        (of.inner_contact, of.outer_contact),
        turning.passing_speeds(of.raceway_radii),
        (found.inner_load, found.outer_load),
        strict=True,
    ):
        load = float(loads.max())
        film = keys.lubricant.film(contact, speed)
        assert film is not None
        central = film.central(load)
        least = film.minimum(load)
        damping = keys.lubricant.damping(film, load)
        outside = [*film.outside(load)]
        numbers = {"load": load, "central": central, "least": least, "damping": damping, "outside": outside}
        told.append({"ring": ring, **numbers})
        thickness = [rounded(1e9 * each) for each in (central, least, least / FULL)]
        rows.append([ring, rounded(load, 4), *thickness, rounded(damping), ", ".join(outside) or "none"])
    at = keys.lubricant.temperature
    title = f"Films of oil, {rounded(1e3 * oil.viscosity(at))} mPa s at {at:g} °C, under the heaviest loads"
    head = [
        "ring",
        "N",
        "middle, nm",
        "least, nm",
        "rms for Λ = 3, nm",
        "damping, N s/m",
        "outside of the fit",
    ]
    say_table(title, head, rows, width=WIDTH)
    say(
        "Contacts are full of oil. For a film that separates them both surfaces together have that rms "
        "within the contact at most."
    )
    return told
