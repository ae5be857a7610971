"""
A rotor on two ball bearings
============================

A program of rotors wants the stiffness of a bearing over the speed. Two angular contact bearings carry a
shaft with a disc; balls that are thrown outwards at speed take stiffness from the inner ring. ROSS (``pip
install ross-rotordynamics``) takes the table as it is.
"""

import importlib.util

import matplotlib.pyplot as plt
import numpy as np

from asperity import BallBearing
from asperity.structures.stiffness_table import stiffness_table

bearing, speeds, preloads = BallBearing.named("7205C"), np.linspace(0.0, 200.0, 6), [50.0, 150.0, 450.0]
table = stiffness_table(bearing, axial=preloads, speed=speeds, contact_damping=20.0)
radial, axial = table.stiffness[0, :, :, 0, 0, 0], table.stiffness[0, :, :, 0, 2, 2]

figure, axes = plt.subplots(figsize=(8.0, 4.0), layout="constrained")
for preload, k, along in zip(preloads, radial, axial, strict=True):
    (line,) = axes.plot(60.0 * speeds, 1e-6 * k, label=f"radial, preload {preload:.0f} N")
    axes.plot(60.0 * speeds, 1e-6 * along, "--", color=line.get_color(), label="axial")
axes.set(xlabel="speed / (1/min)", ylabel="stiffness / (N/µm)", ylim=(0.0, None))
axes.legend(ncols=3)
plt.show()

# %%
# A light preload loses its stiffness with speed, a heavy one does not. Without a radial load nothing couples
# x and y.

assert (np.diff(radial[0]) < 0.0).all()
assert radial[0, -1] < 0.5 * radial[0, 0] < radial[2, -1]
assert np.allclose(table.stiffness[..., 0, 1], 0.0)

# %%
# Each combination of loads is an element of ROSS over rad/s. A shaft that is stiff beside its bearings, with
# a mass M in its middle, has the frequency sqrt(2 k/M)/2π; that of a shaft of 25 mm lies below it.

element = next(each for each in table.elements() if each["load"]["axial"] == 150.0)
coefficients = {name: values for name, values in element.items() if name != "load"}
mass, last = 5.0, 2.0 * np.pi * speeds[-1]
rigid = np.sqrt(2.0 * coefficients["kxx"][-1] / mass) / (2.0 * np.pi)
assert coefficients["frequency"][-1] == last

if importlib.util.find_spec("ross") is None:
    print(f"On stiff shafts {rigid:.0f} Hz. For a bending one: pip install ross-rotordynamics 'plotly<6'")
else:
    import ross

    steel = ross.Material(name="steel", rho=7850.0, E=210e9, Poisson=0.3)
    shaft = [ross.ShaftElement(L=0.05, idl=0.0, odl=0.025, material=steel) for _ in range(6)]
    disc = ross.DiskElement(n=3, m=mass, Id=0.01, Ip=0.02)
    held = [ross.BearingElement(n=node, **coefficients) for node in (0, 6)]
    found = ross.Rotor(shaft, [disc], held).run_modal(speed=last).wn[0] / (2.0 * np.pi)
    print(f"On stiff shafts {rigid:.0f} Hz, on this one {found:.0f} Hz.")
    assert found < rigid
