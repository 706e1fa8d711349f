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

import matplotlib.pyplot as plt
import numpy as np
from duhamel import preprocess, solver
from duhamel.solver import (
    Fixed,
    FlexibleBody,
    Frame,
    Model,
    Place,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    Torque,
)

ROOT = Path.cwd().parent  # the checkout of the sources

# %%
beam = preprocess.build(preprocess.read_body(ROOT / "meshes/beam/beam.toml"))
hub = RigidBody(0.01, [0.0095095, 0.0095095, 0.019019], {"rim": Frame([0.05, 0, 0])})
blade = FlexibleBody(beam, start=Start(place=Place("root", "hub.rim")))
pivot = Revolute("ground", "hub", [0, 0, 1], name="pivot")
clamp = Fixed("hub.rim", "beam.root", name="clamp")
spring = Spring(
    "spring", "torsion", ("ground", "hub"), stiffness=50.0, damping=0.02, axis=[0, 0, 1]
)
torque = Torque("hub", [0, 0, 1], solver.Constant(0.0))
model = Model(
    {"hub": hub, "beam": blade},
    [pivot, clamp],
    springs=[spring],
    loads=[torque],
    settings=Settings(t_end=0.1),
)

# %% [markdown]
# ## Modes

# %%
linear = solver.linearize(model)
modes = linear.modes(6)
for frequency, ratio in zip(modes.frequencies, modes.ratios, strict=True):
    print(f"{frequency:9.3f} Hz, damping {100 * ratio:.3f} %")

# %% [markdown]
# ## A frequency response
#
# From the torque on the hub to the angle of the hub: at rest it is one over the stiffness of
# the spring.

# %%
frequencies = np.linspace(0.0, 150.0, 1500)
response = linear.frf(["load:1"], ["coordinate:pivot:angle"], frequencies)
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
