# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # A shock, and its response spectra
#
# The beam of the paper is clamped to a table that is shaken by half a sine of 50 g in 6 ms.
# What does an instrument on the table feel, and what one at the tip?

# %%
from pathlib import Path

import duhamel as du
import matplotlib.pyplot as plt
from duhamel.results import series

ROOT = Path.cwd().parent  # the checkout of the sources
G = 9.80665

# %%
beam = du.Part.read(ROOT / "meshes/beam/beam.toml").superelement()
m = du.Mechanism()
shelf = m.add(beam, name="beam", place={"root": m.ground})
shock = du.signals.HalfSine(50 * G, 6e-3, 1e-3)
m.add(du.joints.Prismatic(m.ground, shelf["root"], "z", name="table", acceleration=shock))
run = m.simulate(0.1, step=2e-5, rho_inf=0.9)

# %% [markdown]
# ## The motion

# %%
root, tip = (run[f"beam.{name}"].acceleration[:, 2] for name in ("root", "tip"))
plt.figure(figsize=(8, 3))
plt.plot(1e3 * run.time, tip / G, label="tip")
plt.plot(1e3 * run.time, root / G, label="root")
plt.xlabel("time [ms]")
plt.ylabel("acceleration [g]")
plt.legend()
plt.show()

# %% [markdown]
# ## Shock response spectra
#
# The largest acceleration of oscillators of every frequency, with Q = 10, that stand on the
# table or on the tip.

# %%
plt.figure(figsize=(8, 4))
spectra = {}
for name, acceleration in {"root": root, "tip": tip}.items():
    spectra[name] = series.shock_spectrum(run.time, acceleration, q=10.0)
    plt.loglog(spectra[name].frequency, spectra[name].values / G, label=name)
plt.xlabel("frequency [Hz]")
plt.ylabel("acceleration [g], Q = 10")
plt.grid(visible=True, which="both", alpha=0.3)
plt.legend()
plt.show()

# %% [markdown]
# On the table the spectrum of a half sine is 1.65 times its peak; at the tip it stands out at
# the frequencies of the clamped beam.

# %%
peak = spectra["root"].values.max() / (50 * G)
assert abs(peak - 1.65) < 0.02
peak
