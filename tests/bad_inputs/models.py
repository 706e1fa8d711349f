"""Models that have, between them, every table of a model file, as documents."""

import tomllib
from typing import Any

MECHANISM = """
[simulation]
t_end = 0.003
step = 1e-3
rho_inf = 0.8
gravity = [0, 0, -9.81]

[output]
every = 1

[ground.frames.post]
position = [0.3, 0.2, 0.1]

[bodies.hub]
mass = 2.0
inertia = [0.1, 0.2, 0.25]
frames.rim = {position = [0.5, 0, 0]}

[bodies.beam]
superelement = "beam.h5"
place = {frame = "root", on = "hub.rim"}

[bodies.pad]
superelement = "beam.h5"
position = [0, 0, 5]
scale = {stiffness = 1.5, density = 0.8, damping = 2.0}

[bodies.ball]
mass = 1.0
inertia = [0.1, 0.1, 0.1]
position = [0, 2, 0]

[[joints]]
name = "pivot"
type = "revolute"
between = ["ground", "hub"]
axis = [0, 0, 1]
start = {angle = 0.1, angle_rate = 0.2}
friction = {coefficient = 0.1, radius = 0.01, width = 0.1, preload = 1.0, viscous = 0.1}

[[joints]]
name = "clamp"
type = "fixed"
between = ["hub.rim", "beam.root"]

[[joints]]
name = "glide"
type = "point_on_plane"
between = ["ground", "ball"]
axis = [0, 1, 0]
reference_coordinates = {distance = 0.1}

[[springs]]
name = "tie"
type = "point"
between = ["ground.post", "beam.tip"]
stiffness = 100.0
damping = 1.0
rest = 0.2
law = {deformation = [-0.1, 0, 0.2], force = [-9, 0, 4]}

[[springs]]
name = "bush"
type = "bushing"
between = ["ground", "ball"]
stiffness = [9, 9, 9, 7, 7, 7]

[[contacts]]
name = "touch"
between = ["ground.post", "ball"]
shape = "sphere"
radius = 0.1
ball = 0.05
hertz = {E = [2e11, 7e10], nu = [0.3, 0.33]}
patch = [0, 0.001]
restitution = 0.5
slow = 0.02
friction = {static = 0.3, sliding = 0.2, speed = 0.01}
tangential_stiffness = 1e5
tangential_damping = 3.0

[[contacts]]
name = "rail"
between = ["ground.post", "ball"]
shape = "cylinder"
axis = [0, 0, 1]
radius = 9.0
hollow = true
length = 9.0
ball = 0.05
law = {penetration = [0, 1e-3, 3e-3], force = [0, 5, 20]}
damping = 0.1

[[contacts]]
name = "cam"
between = ["hub.rim", "ball"]
shape = "profile"
axis = [0, 0, 1]
points = [[0.1, 0], [0, 0.1], [-0.1, 0], [0, -0.1], [0.1, 0]]
ball = 0.05
stiffness = 1e5
exponent = 1.5

[[contacts]]
name = "press"
surfaces = ["pad.flank", "ground.post"]
shape = "plane"
axis = [0, 0, 1]
layer = 1e12
margin = 1e-3

[[stops]]
name = "end"
joint = "pivot"
coordinate = "angle"
range = [-1.0, 2.0]
stiffness = 1e3

[[couplers]]
name = "mix"
type = "linear"
joints = ["glide.second_distance"]
ratios = [2.0]
offset = {polynomial = [0, 1e-3]}

[[bearings]]
name = "film"
between = ["ground", "ball"]
axis = [0, 0, 1]
speeds = [-10.0, 20.0]
stiffness = [[9.0, 1.0, -1.0, 9.0], [8.0, 1.0, -1.0, 8.0]]
damping = [[0.2, 0.0, 0.0, 0.2], [0.1, 0.0, 0.0, 0.1]]

[[motors]]
name = "servo"
joint = "pivot"
coordinate = "angle"
torque = 1.0
reference = {polynomial = [0.1, 0.2]}
reference_rate = 0.2
stiffness = 9.0
damping = 1.0
integral = 9.0
limit = [-9.0, 8.0]
speed = 30.0
tracking_time = 0.1

[[motions]]
name = "shake"
on = "ball"
direction = [1, 0, 0]
displacement = {amplitude = 0.01, frequency = 20}

[[motions]]
name = "turn"
on = "ball"
axis = [0, 0, 1]
angle = {polynomial = [0, 0, 1]}

[[loads]]
type = "torque"
on = "hub"
direction = [0, 0, 1]
signal = 1.0
follower = false

[[loads]]
type = "pattern"
body = "beam"
pattern = "wind"
signal = 2.0
"""

STEADY = """
[simulation]
t_end = 0.003
step = 1e-3
start = "equilibrium"
steady_rotation = {angular_velocity = [0, 0, 2]}

[bodies.rotor]
mass = 2.0
inertia = [0.1, 0.1, 0.15]

[[joints]]
name = "bearing"
type = "cylindrical"
between = ["ground", "rotor"]
axis = [0, 0, 1]
angle = {polynomial = [0, 2]}
distance = 0
"""

PUSH = """
[simulation]
t_end = 0.003
step = 1e-3

[bodies.hub]
mass = 2.0
inertia = [0.1, 0.2, 0.25]

[[loads]]
type = "force"
on = "hub"
direction = [0, 0, 1]
signal = 1.0
"""
"""a small one, for the many forms of signals"""

AXIS = {"axis": [0, 0, 1]}
JOINTS: dict[str, dict[str, Any]] = {
    "fixed": {},
    "spherical": {},
    "revolute": AXIS,
    "universal": AXIS | {"second_axis": [1, 0, 0]},
    "cylindrical": AXIS,
    "prismatic": AXIS,
    "planar": AXIS,
    "rod": {"between": ["ground.far", "hub"]},
    "screw": AXIS | {"lead": 0.1},
    "constant_velocity": AXIS,
    "point_on_line": AXIS,
    "point_on_plane": AXIS,
    "rolling_disc": AXIS | {"second_axis": [1, 0, 0], "radius": 1.0},
}
LOADS: dict[str, dict[str, Any]] = {
    "force": {"direction": [0, 0, 1], "signal": 1.0},
    "torque": {"direction": [0, 0, 1], "signal": 1.0},
    "drag": {"quadratic": 1.0},
}


def pushed(**tables: Any) -> dict[str, Any]:
    """A small document with other joints or loads."""
    far = {"frames": {"far": {"position": [0, 0, 1]}}}
    return tomllib.loads(PUSH) | {"ground": far} | tables


COUPLED = """
[[motors]]
name = "motor"
joint = "pivot"
coordinate = "angle"
torque = {input = "tau"}

[[fmus]]
name = "drive"
file = "drive.fmu"
step = 2e-3
inputs = {angle = "joints/pivot/angle", rate = "joints/pivot/angle_rate"}
outputs = {torque = "tau"}
parameters = {kp = 2.0}
coupling = "slope"
"""
"""tables of a hub on a pivot, whose motor an FMU commands"""
DOCUMENTS: dict[str, dict[str, Any]] = {
    "mechanism": tomllib.loads(MECHANISM),
    "steady": tomllib.loads(STEADY),
    "push": tomllib.loads(PUSH),
    "coupled": pushed(
        joints=[{"name": "pivot", "type": "revolute", "between": ["ground", "hub"], **AXIS}],
        **tomllib.loads(COUPLED),
    ),
}
KINDS = {
    f"{kind} joint": pushed(
        joints=[{"name": "knee", "type": kind, "between": ["ground", "hub"]} | keys]
    )
    for kind, keys in JOINTS.items()
} | {f"{kind}": pushed(loads=[{"type": kind, "on": "hub"} | keys]) for kind, keys in LOADS.items()}
"""documents with one joint or one load, of each kind"""
DOCUMENTS |= KINDS

SIGNALS: dict[str, dict[str, Any]] = {
    "Steps": {"times": [0, 1], "values": [2, 3]},
    "Table": {"times": [0, 1], "values": [2, 3], "linear": True},
    "Spline": {"times": [0, 1, 2], "values": [0, 3, 1], "spline": True},
    "Harmonic": {"amplitude": 1, "frequency": 2, "phase": 0.1, "offset": 0.2},
    "Polynomial": {"polynomial": [0, 1, 2]},
    "Impulse": {"impulse": 1, "at": 0.001},
    "Pulse": {"pulse": 1, "from": 0.001, "to": 0.002},
    "Input": {"input": "motor", "value": 1},
    "SmoothStep": {"smooth_step": [0, 1], "over": [0, 0.001]},
    "Haversine": {"smooth_step": [0, 1], "over": [0, 0.001], "haversine": True},
    "HalfSine": {"half_sine": 1, "duration": 0.001, "from": 0.001},
    "Trapezoid": {"trapezoid": 1, "duration": 0.001, "rise": 0.0001, "fall": 0, "from": 0},
    "Sawtooth": {"sawtooth": 1, "duration": 0.001, "from": 0},
    "Window": {"window": [0, 0.003], "rise": 0.001, "fall": 0.001},
    "Chirp": {"chirp": 1, "frequencies": [5, 50], "over": [0, 1], "phase": 0},
    "LogarithmicChirp": {
        "chirp": 1,
        "frequencies": [5, 50],
        "over": [0, 1],
        "logarithmic": True,
    },
    "Noise": {"noise": 1, "band": [5, 50], "period": 1, "seed": 3},
    "ShapedNoise": {"spectrum": [[5, 1], [50, 2]], "period": 1, "seed": 3},
    "Recorded": {
        "file": "record.csv",
        "column": "a",
        "scale": 2,
        "time": 1,
        "time_scale": 1,
        "shift": 0,
    },
    "RecordedSpline": {"file": "record.csv", "column": 2, "spline": True},
    "Sum": {"sum": [1, {"amplitude": 1, "frequency": 2}]},
    "Product": {"product": [2, {"half_sine": 1, "duration": 0.001}]},
    "Delayed": {"delay": 0.001, "of": {"half_sine": 1, "duration": 0.001}},
}
"""by class: each form of signal in a file"""

RECORD = "t,a\n0,1\n0.002,3\n"
"""record.csv, beside the models"""

SHAPES: dict[str, dict[str, Any]] = {
    "Box": {"box": [0.1, 0.2, 0.3], "center": [0, 0, 1]},
    "Cylinder": {"cylinder": {"radius": 0.1, "length": 1, "axis": [0, 0, 1]}, "center": [0, 0, 1]},
    "Sphere": {"sphere": 0.1, "center": [0, 0, 1]},
    "Surface": {"stl": "part.stl", "scale": 0.001, "center": [0, 0, 1]},
}
"""by class: each form of shape"""

PART = """solid part
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid part
"""
"""part.stl, beside the models"""

LAWS: dict[str, dict[str, Any]] = {
    "TabulatedLaw": {"deformation": [-1, 0, 1], "force": [-1, 0, 1]},
    "OneSidedLaw": {"gap": 0.1, "stiffness": 1, "exponent": 1.5, "side": "extension"},
    "DamperLaw": {"compression": 1, "rebound": 2},
    "TabulatedDamperLaw": {"rate": [-1, 0, 1], "force": [-1, 0, 2]},
    "MaxwellLaw": {"relaxation_times": [0.1, 1], "stiffness": [1, 2]},
    "BoucWenLaw": {
        "yield_deformation": 0.1,
        "stiffness": 1,
        "post_yield": 0.1,
        "exponent": 2,
        "beta": 0.6,
    },
    "ElastoplasticLaw": {
        "yield_force": 0.1,
        "stiffness": 1,
        "post_yield": 0.1,
        "isotropic": 0.5,
    },
    "IwanLaw": {"slip_force": 1, "stiffness": 1, "chi": -0.3, "beta": 0.2, "elements": 30},
}
"""by class: each form of force law"""
