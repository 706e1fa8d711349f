"""Small bodies with surfaces, and runs of them step by step, for tests of their contacts."""

import warnings
from functools import cache

import duhamel as du
import numpy as np
import skfem
from duhamel.solver.lower.allocation import make_output
from duhamel.solver.start.initial import initialize
from duhamel.solver.step.events import is_full
from duhamel.solver.step.history import modal_energy
from duhamel.solver.step.loop import advance
from duhamel.solver.step.system import Inputs, Run

STEEL = du.Material(E=210e9, nu=0.3, rho=7800.0)
EDGE = 0.008
"""of blocks, which lie with their center at the origin [m]"""


@cache
def block(n=3, ends=False, edge=EDGE, spread=False):
    """A cube of n^3 hexahedra with the surfaces `low` and `top`, and the halves of `low`.

    ends: with the interfaces `left` and `right` at its ends along x; spread: with the load pattern
    `press`, a force of 1 N down that is spread over `top`.
    """
    half, tip = 0.5 * edge, 1e-6 * edge
    part = du.Part(skfem.MeshHex.init_tensor(*[np.linspace(-half, half, n + 1)] * 3), STEEL)
    part.surface("low", du.plane(z=-half))
    part.surface("top", du.plane(z=half))
    if n % 2 == 0:
        for name, low, high in (("west", -half, 0.0), ("east", 0.0, half)):
            corners = [low - tip, -half - tip, -half - tip], [high + tip, half + tip, -half + tip]
            part.surface(name, du.box(*corners))
    if ends:
        part.interface("left", du.plane(x=-half))
        part.interface("right", du.plane(x=half))
    if spread:
        part.load("press", du.plane(z=half), pressure=1.0 / edge**2)
    return quietly(part, step=1e-6, band=4e5)


@cache
def arm():
    """A bar of 80 x 8 x 4 mm from x = 0 with the surface `low` near its `tip`."""
    lines = np.linspace(0.0, 0.08, 17), np.linspace(-0.004, 0.004, 3), [-0.002, 0.0, 0.002]
    part = du.Part(skfem.MeshHex.init_tensor(*map(np.array, lines)), STEEL)
    part.surface("low", du.box([0.06, -0.005, -0.0021], [0.081, 0.005, -0.0019]))
    part.interface("root", du.plane(x=0.0))
    part.interface("tip", du.plane(x=0.08))
    return quietly(part, step=2e-7, band=1.5e5)


def quietly(part, **impulse):
    with warnings.catch_warnings():
        # of the few elements in a wave: these bodies are compared with themselves
        warnings.simplefilter("ignore", du.preprocess.PlausibilityWarning)
        return part.superelement(**impulse)


class Motion:
    """A run, step by step, with the sum of forces and the energy after each of its steps."""

    def __init__(self, model):
        initial = initialize(model)
        self.lowered, self.state, self.work = initial.lowered, initial.state, initial.work
        self.warnings = initial.warnings
        self.system = self.lowered.system
        self._run = Run(
            system=self.system,
            state=self.state,
            work=self.work,
            output=make_output(self.lowered, 2),
        )
        signals = self.lowered.load_signals, self.lowered.drives, self.lowered.motor_signals
        load, drive, motor = (np.zeros((1, len(own))) for own in signals)
        self._inputs = Inputs(load=load, drive=drive, motor=motor, row=np.array([-1]), ahead=0)
        self.energies = [self.energy]
        self.forces = [0.0]

    def step(self, n=1):
        """Take n steps; False where one failed."""
        for _ in range(n):
            taken, _ = advance(self._run, self._inputs)
            if not taken:
                return False
            if is_full(self.state.contacts):
                self.state.contacts.n_events[0] = 0  # nobody reads them
            self.energies.append(self.energy)
            self.forces.append(float(self.state.surfaces.force.sum()))
        return True

    @property
    def energy(self):
        energies = self.state.energies
        elastic = modal_energy(self.system.elastic, self.state)
        return float(energies.kinetic[0] + elastic + energies.residual[0])

    @property
    def gain(self):
        """The largest gain of energy, over that at the start."""
        return max(self.energies) / self.energies[0] - 1.0

    @property
    def impulse(self):
        return sum(self.forces) * self.lowered.h

    @property
    def closings(self):
        closed = np.array(self.forces) > 0.0
        return int((closed[1:] & ~closed[:-1]).sum())
