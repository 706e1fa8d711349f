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
# # Modes and frequency responses
#
# A run is one motion. Linear analysis says what all small motions about an equilibrium are:
# frequencies, damping, shapes, responses. The mechanism is a beam on a hub, held by a torsion
# spring.

# %%
from pathlib import Path

import duhamel as du
import matplotlib.pyplot as plt
import numpy as np

ROOT = Path.cwd().parent  # the checkout of the sources

# %%
beam = du.Part.read(ROOT / "meshes/beam/beam.toml").superelement()
m = du.Mechanism()
wheel = du.RigidBody(0.01, [0.0095095, 0.0095095, 0.019019], {"rim": [0.05, 0, 0]})
hub = m.add(wheel, name="hub")
blade = m.add(beam, name="beam", place={"root": hub["rim"]})
m.add(du.joints.Revolute(m.ground, hub, axis="z", name="pivot"))
m.add(du.joints.Fixed(hub["rim"], blade["root"], name="clamp"))
m.add(du.springs.torsion(m.ground, hub, "z", stiffness=50.0, damping=0.02))

# %% [markdown]
# ## Modes

# %%
modes = m.modes(6)
for frequency, ratio in zip(modes.frequencies, modes.ratios, strict=True):
    print(f"{frequency:9.3f} Hz, damping {100 * ratio:.3f} %")

# %% [markdown]
# ## A frequency response
#
# From the torque on the hub to the angle of the hub: at rest it is one over the stiffness of
# the spring.

# %%
frequencies = np.linspace(0.0, 150.0, 1500)
response = m.frf(["torque:hub:z"], ["pivot.angle"], frequencies)
angle = np.abs(response.values[:, 0, 0])
plt.figure(figsize=(8, 4))
plt.semilogy(frequencies, angle)
plt.xlabel("frequency [Hz]")
plt.ylabel("angle per torque [rad/(N m)]")
plt.grid(visible=True, alpha=0.3)
plt.show()

# %%
assert abs(angle[0] - 1 / 50.0) < 1e-9
angle[0]
