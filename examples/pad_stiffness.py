"""
Rail pads: the sound of rail, sleepers and wheel
================================================

A wheel of 600 kg rolls at 108 km/h on a rail with the roughness of ISO 3095, over pads of one material: their
loss factor stays, their stiffness goes from soft to stiff. Stiff pads hold the rail to its sleepers. Its
waves then decay within fewer metres, so that less of the rail is heard, but more gets into the sleepers; the
quietest pad lies between. On the command line the same is one table,
`asperity study case.toml --vary "track.pad_stiffness = 60..2000 MN/m, 3 ratios"`.
"""

from concurrent.futures import ThreadPoolExecutor

import matplotlib.pyplot as plt
import numpy as np

import asperity

case = asperity.WheelOnRail(
    speed="30 m/s",
    laws=["linear-filtered"],
    duration="0.5 s",
    settling="0.1 s",
    surface={"spectrum": "iso3095"},
    wheel={"roughness": "disc", "section": "straight-web"},
    track={"name": "uic60", "pad_loss_factor": 0.2, "points": ["5 m"]},
    contact={"spacing": "1 mm", "samples": 2},
    numerics={"poles": 60},
    noise={"wheelbase": "2.5 m"},
)
pads = ["60 MN/m", "150 MN/m", "400 MN/m", "1 GN/m", "2 GN/m", "4 GN/m"]
with ThreadPoolExecutor(2) as here:
    table = asperity.study(case, {"track.pad_stiffness": pads}, executor=here).sel(law="linear-filtered")

# %%
# Sound power of an axle by what radiates, and how loud a bogie is 7.5 m away:

power = table["radiated_power_level_a"]
stiffness = power["track.pad_stiffness"].values / 1e6
figure, axes = plt.subplots(figsize=(7, 4.6), layout="constrained")
for name, look in {"rail": "C0o-", "sleepers": "C2s-", "wheel": "C1^-", "total": "ko-"}.items():
    axes.semilogx(stiffness, power.sel(radiator=name), look, lw=2.5 if name == "total" else 1.5, label=name)
axes.set(xlabel="pad stiffness / (MN/m)", ylabel="sound power level / dB(A) re 1 pW")
axes.set_xticks(stiffness, [f"{each:g}" for each in stiffness])
axes.minorticks_off()
axes.grid(alpha=0.3)
axes.legend()
plt.show()

for pad, maximum in zip(pads, table["pass_by_maximum_level"].values, strict=True):
    print(f"{pad:>8}: {maximum:.1f} dB(A) at most as a bogie passes")

# %%
# What textbooks say (D. J. Thompson, Railway Noise and Vibration, 2009): the rail gets quieter with stiffer
# pads, the sleepers louder, the wheel changes least, and the quietest pad lies between. With a viscous damper
# that stays, the loss factor would fall as pads get stiffer, and the rail would gain little.

assert (np.diff(power.sel(radiator="rail"))[:-1] < -0.5).all()
assert (np.diff(power.sel(radiator="sleepers")) > 0.5).all()
change = power.max("track.pad_stiffness") - power.min("track.pad_stiffness")
assert change.sel(radiator="wheel") < 0.7 * min(change.sel(radiator=["rail", "sleepers"]))
assert 0 < np.argmin(power.sel(radiator="total").values) < len(pads) - 1
