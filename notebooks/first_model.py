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
# # A first model in Python
#
# Half a meter of aluminium on a hub that a torque turns and stops: Case 1 of the paper. First
# the mesh becomes a superelement; then a model of a rigid hub and that beam is simulated and
# drawn.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
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
    Start,
    Torque,
)

ROOT = Path.cwd().parent  # the checkout of the sources

# %% [markdown]
# ## The superelement
#
# `beam.toml` names a mesh of ten beams, the section, two interfaces (`root` and `tip`) and the
# step.

# %%
beam = preprocess.build(preprocess.read_body(ROOT / "meshes/beam/beam.toml"))
print(beam.name, "-", beam.mass, "kg, interfaces:", [i.name for i in beam.interfaces])
print("first frequencies, free [Hz]:", (beam.modes.omega[:4] / 6.283185).round(1))

# %% [markdown]
# ## The model
#
# A hub turns about z; the beam starts with its root on the rim of the hub and is clamped there.
# The torque is 2 N m for 0.05 s, and -2 N m later: its signal is a table of steps.

# %%
hub = RigidBody(0.01, [0.0095095, 0.0095095, 0.019019], {"rim": Frame([0.05, 0, 0])})
blade = FlexibleBody(beam, start=Start(place=Place("root", "hub.rim")))
pivot = Revolute("ground", "hub", [0, 0, 1], name="pivot")
clamp = Fixed("hub.rim", "beam.root", name="clamp")
torque = Torque("hub", [0, 0, 1], solver.Steps([0, 0.05, 0.15, 0.2], [2, 0, -2, 0]))
model = Model(
    {"hub": hub, "beam": blade}, [pivot, clamp], loads=[torque], settings=Settings(t_end=0.3)
)
print("\n".join(solver.check(model).lines()))

# %% [markdown]
# ## The run

# %%
results = solver.simulate(model)
print(results.validity)

# %% [markdown]
# ## What came of it
#
# The speed of the hub, and how far the tip is bent, seen from the beam's own axes.

# %%
figure, (upper, lower) = plt.subplots(2, 1, sharex=True, figsize=(8, 5))
upper.plot(results.time, results.body("hub").v[:, 5])
upper.set_ylabel("hub [rad/s]")
lower.plot(results.time, 1e3 * results.frame("beam.tip").u[:, 1])
lower.set_ylabel("tip, elastic [mm]")
lower.set_xlabel("time [s]")
plt.show()

# %% [markdown]
# The hub reaches 4.214 rad/s, as a geometrically exact beam has it (4.21398 rad/s, Exudyn).

# %%
peak = results.body("hub").v[:, 5].max()
assert abs(peak - 4.21398) < 1e-3
peak
