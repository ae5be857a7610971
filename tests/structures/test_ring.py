"""Rings: modes of unit mass, their energy of bending, what is held and what is free."""

import numpy as np
import pytest

from asperity.structures.modal import ModalStructure
from asperity.structures.ring import Around, Ring
from refusals import refusals

MASS, RADIUS, STIFFNESS = 0.3, 26e-3, 40.0


def test_lobes_have_unit_mass_and_the_energy_of_bending_of_their_frequency():
    """∮ μ (w² + v²) R dψ = 1 with v' = −w, and ∮ EI (w″ + w)²/R³ dψ = ω², by quadrature."""
    ring = Ring.bending(MASS, RADIUS, STIFFNESS, most_lobes=4, damping_ratio=0.01)
    psi, step = np.linspace(0.0, 2 * np.pi, 720, endpoint=False, retstep=True)
    w, slope = ring.shapes(psi)
    assert np.allclose(slope[1:-1], np.gradient(w, psi, axis=0)[1:-1], atol=1e-3 * np.abs(slope).max())
    n = np.array([2, 2, 3, 3, 4, 4])
    v = -np.cumsum(w, axis=0) * step
    v -= v.mean(axis=0)
    mass = MASS / (2 * np.pi * RADIUS) * (w**2 + v**2).sum(axis=0) * RADIUS * step
    assert mass == pytest.approx(np.ones(6), rel=1e-3)
    bent = STIFFNESS / RADIUS**3 * (((1 - n**2) * w) ** 2).sum(axis=0) * step
    assert np.sqrt(bent) / (2 * np.pi) == pytest.approx(ring.natural_frequencies, rel=1e-9)


def test_a_rigid_ring_moves_as_a_mass_on_its_springs():
    ring = Ring.rigid(2.0, 0.4, radial_stiffness=8e6, axial_stiffness=2e6, damping_ratio=0.05)
    assert ring.natural_frequencies * 2 * np.pi == pytest.approx([2e3, 2e3, 1e3])
    (along, across), _ = ring.shapes([0.0, np.pi / 2])
    assert along * np.sqrt(2.0) == pytest.approx([np.cos(0.4), 0.0, np.sin(0.4)])
    assert across * np.sqrt(2.0) == pytest.approx([0.0, np.cos(0.4), np.sin(0.4)])
    assert ring.towards(np.pi / 2) * np.sqrt(2.0) == pytest.approx([0.0, 1.0, 0.0])
    assert ring.towards(1.0, "axial") * np.sqrt(2.0) == pytest.approx([0.0, 0.0, 1.0])
    assert ring.pressed(3.0, 5.0) * np.sqrt(2.0) == pytest.approx([3.0, 0.0, 5.0])


def around(angles, shapes):
    return Around(ModalStructure(angles, np.full(shapes.shape[1], 900.0), 0.01, shapes), 0.3)


def test_modes_around_a_circle_from_a_table_are_those_of_the_ring():
    ring = Ring.bending(MASS, RADIUS, STIFFNESS, 0.3, most_lobes=2, damping_ratio=0.01)
    table = np.linspace(0.0, 2 * np.pi, 181)
    read = around(table, ring.shapes(table)[0] / np.cos(0.3))
    at = np.array([-1.0, 0.1, 7.0])
    for found, expected in zip(read.shapes(at), ring.shapes(at), strict=True):
        assert found == pytest.approx(expected, abs=1e-6)
    assert read.towards(0.7) == pytest.approx(ring.towards(0.7), rel=1e-6)
    assert not read.towards(0.7, "axial").any()


test_what_is_no_ring_is_refused = refusals(
    (lambda: Ring.rigid(0.0), "mass of a ring"),
    (lambda: Ring.rigid(1.0, radial_stiffness=-1.0), "radial stiffness of a ring"),
    (lambda: Ring.rigid(1.0, damping_ratio=1.0), "damping_ratio.*below 1"),
    (lambda: Ring.bending(1.0, 0.1, 0.0, most_lobes=2, damping_ratio=0.1), "bending stiffness of a ring"),
    (lambda: Ring.bending(1.0, 0.1, 1.0, most_lobes=1, damping_ratio=0.1), "lobes.*2 or more"),
    (lambda: Ring.rigid(1.0).pressed(0.0, 1.0), "axial load"),
    (lambda: around([0.0, 1.0, 2.0, 3.0], np.ones((4, 1))), "angles of modes.*0 to 3.*a whole turn"),
    (
        lambda: around(np.linspace(0.0, 2 * np.pi, 9), np.linspace(1.0, 1.2, 9)[:, None]),
        "modes around a circle.*apart.*Repeat the first row",
    ),
)
