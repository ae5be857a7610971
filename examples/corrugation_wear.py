"""
Does a corrugation grow?
========================

A driven wheel rolls over a rail with a wave of 0.2 µm. If it wears the crests more than the troughs, the
wave goes; if the troughs, it grows. The contact alone presses harder on crests. The force between wheel and
rail may be largest elsewhere, because both have mass.

The wear of a wave as small as this is linear, w/w₀ = 1 + A z + B f/f₀, in waves of the rail, z, and of the
force, f. Both factors are found by rolling, step by step, with stick and slip, at a constant creepage.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity

steel, radius, load, n, cell = asperity.material("steel"), 0.4, 60e3, 32, 0.5e-3
x = cell * (np.arange(n) - 0.5 * (n - 1))
wheel = np.add.outer(x**2, x**2) / (2 * radius)
modulus = 0.5 * steel.youngs_modulus / (1 - steel.poisson_ratio**2)
space, hertz = asperity.HalfSpace((n, n), cell, modulus), asperity.Hertz(modulus, radius, radius)
law = asperity.EnergyWear(plateau=np.inf, onset=np.inf)  # in proportion to friction work


def wave_of_wear(cells, friction, creepage, rail=0.0, force=0.0):
    """Wave of the wear over its mean, complex, of waves of so many cells of the rail, m, and of f/f₀."""
    place = np.arange(cells * -(-2 * n // cells))  # whole waves, at least two windows
    heights = np.repeat(rail * np.cos(2 * np.pi / cells * place)[:, None], n, axis=1)
    loads = load * (1 + force * np.cos(2 * np.pi / cells * (place + 0.5 * (n - 1))))
    rolling = asperity.FrictionalHalfSpace(space, (steel, steel), friction)
    worn = asperity.worn(rolling, heights, wheel, loads, law, (creepage, 0), closed=True, step=1e-6)
    line = worn.depth.sum(axis=1)
    return 2 * np.mean(line * np.exp(-2j * np.pi / cells * place)) / line.mean()


# %%
# Where all slips, the wear of a force that varies is sin(ka)/(ka) of it, k the wavenumber and a the
# half-width: more force is carried evenly along the contact. Long waves wear in phase with the force.

half_width = hertz.semi_axes(hertz.approach(load))[0]
for cells in (24, 48, 96):
    ka = 2 * np.pi / (cells * cell) * half_width
    found = wave_of_wear(cells, 0.01, 0.04, force=0.02) / 0.02
    print(f"{cells * cell * 1e3:.0f} mm: {found:.3f}, closed form {np.sin(ka) / ka:.3f}")
    assert abs(found - np.sin(ka) / ka) < 0.01

# %%
# The wheel pulls with about four fifths of what friction carries. Under constant force a wave goes, the
# faster the shorter. The wear of a force that varies now comes late: what is stored where the contact sticks
# is set free behind the crests of the force.

cells = np.array([24, 32, 48, 64, 96, 128, 160])
waves = cells * cell
A = np.array([wave_of_wear(m, 0.3, 0.002, rail=0.2e-6) for m in cells]) / 0.2e-6
B = np.array([wave_of_wear(m, 0.3, 0.002, force=0.02) for m in cells]) / 0.02
late = -np.angle(B[-1]) / (2 * np.pi / waves[-1])
print(f"wear of a force comes {late * 1e3:.1f} mm late, the half-width is {half_width * 1e3:.1f} mm")
assert (A.real > 0).all()
assert 0.5 * half_width < late < 1.5 * half_width

# %%
# The force follows from the wave by the receptances: f/z = 1/(1/k_H − 1/(Mω²) + α). Growth, in percent for
# each micrometre worn, is −Re(A + B f/(f₀ z)). On a track the wave does not grow. On a rail that does not
# give it does, where the wheel on its contact is below resonance: the force is largest in the troughs. A
# creepage that varies, too, is not in this.

wave = np.linspace(waves[0], waves[-1], 200)
omega, stiffness, mass = 2 * np.pi * 15.0 / wave, hertz.tangent_stiffness(hertz.approach(load)), 350.0
give = asperity.Track.named("uic60").receptance(omega / (2 * np.pi), 0.3, 0.3)
forces = {
    "constant force": 0 * omega,
    "wheel on a track, 15 m/s": 1 / (1 / stiffness - 1 / (mass * omega**2) + give),
    "wheel on a rail that does not give": 1 / (1 / (stiffness * (1 + 0.05j)) - 1 / (mass * omega**2)),
}
growth = {}
figure, axes = plt.subplots(figsize=(7.0, 4.4), layout="constrained")
for name, force in forces.items():
    growth[name] = -np.real(np.interp(wave, waves, A) + np.interp(wave, waves, B) * force / load) * 1e-6
    axes.plot(wave * 1e3, 100 * growth[name], label=name)
axes.axhline(0, color="grey", linewidth=0.8)
axes.set(xlabel="wavelength / mm", ylabel="growth / % per µm worn", ylim=(-6, 6))
axes.legend()
plt.show()
resonance = 15.0 * 2 * np.pi * np.sqrt(mass / stiffness)  # as a wavelength
grows = wave[growth["wheel on a rail that does not give"] > 0]
print(f"without a track it grows from {grows.min() * 1e3:.0f} mm on, resonance is {resonance * 1e3:.0f} mm")
assert growth["wheel on a track, 15 m/s"].max() < 0
assert abs(grows.min() / resonance - 1) < 0.05
