"""Mechanisms: bodies and what is between them, built step by step by handles."""

import os
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self, TypeAlias, TypeVar, overload

import numpy as np
from duhamel import solver, superelement, view
from duhamel.inputs import FORM_OF_NAMES, is_name, quoted
from duhamel.results.quantities import KINDS_BY_NAME
from duhamel.results.spelling import quantity_of
from duhamel.solver.model.bodies import Body, Place, Start
from duhamel.solver.model.model import numbered
from duhamel.solver.schema.values import Framed, direction, frame_name
from duhamel.superelement import Superelement
from numpy.typing import ArrayLike

from .parts import Part
from .pictures import embedded
from .runs import Run

if TYPE_CHECKING:
    from duhamel import fmu, study

    from .varied import AnyParameter, VariedMechanism

MODEL_GROUPS = (
    *("joints", "springs", "motions", "loads", "contacts", "stops", "motors", "couplers"),
    *("bearings", "fmus"),
)
"""the arrays of a model, one for each kind of what is between bodies"""
AnyRigidBody: TypeAlias = solver.RigidBody | solver.RigidSuperelement
AnyPart = TypeVar(
    "AnyPart",
    bound=(
        solver.Joint
        | solver.Spring
        | solver.Bearing
        | solver.PrescribedDisplacement
        | solver.PrescribedRotation
        | solver.PrescribedOrientation
        | solver.Load
        | solver.PatternLoad
        | solver.Contact
        | solver.Stop
        | solver.Motor
        | solver.Coupler
        | solver.FMU
    ),
)
"""what acts between bodies"""


class _Owned(str):
    """A name of a mechanism, by which a handle of another one is told apart.

    To the solver, in copies and in files it is a string as any.
    """

    __slots__ = ("mechanism",)
    mechanism: "Mechanism"

    def __new__(cls, name: str, mechanism: "Mechanism") -> Self:
        owned = super().__new__(cls, name)
        owned.mechanism = mechanism
        return owned

    def __reduce__(self) -> tuple[Any, ...]:
        return str, (str(self),)


@dataclass(frozen=True)
class FrameHandle:
    """A frame of a body of a mechanism, for joints, springs, contacts and loads."""

    frame_name: str
    """BODY.FRAME"""

    def __repr__(self) -> str:
        return f"<frame {self.frame_name!r}>"


@dataclass(frozen=True, eq=False)
class BodyHandle:
    """A body of a mechanism; `handle["tip"]` is a frame of it, the handle its center of mass."""

    mechanism: "Mechanism"
    name: str

    @property
    def frame_name(self) -> str:
        """It as a frame, the center of mass."""
        return self.name

    @property
    def body(self) -> Body:
        """What the solver has: mass, inertia, start."""
        return self.mechanism.bodies[self.name]

    @property
    def frames(self) -> tuple[str, ...]:
        """The names of its frames: of an elastic part its interfaces."""
        return tuple(self.body.frames)

    @property
    def surfaces(self) -> tuple[str, ...]:
        """The names of the surfaces of an elastic part, for contacts of surfaces."""
        surfaces = getattr(getattr(self.body, "superelement", None), "surfaces", None)
        return () if surfaces is None else tuple(patch.name for patch in surfaces.patches)

    def __getitem__(self, frame: str) -> FrameHandle:
        """A frame, or a surface by its name."""
        return _frame(self.mechanism, self.name, frame, (*self.frames, *self.surfaces))

    def __repr__(self) -> str:
        return f"<body {self.name!r}, frames: {', '.join(self.frames) or 'none'}>"


@dataclass(frozen=True, eq=False)
class GroundHandle:
    """Space: `m.ground` is where the other frame of a joint starts, `m.ground["wall"]` a frame."""

    mechanism: "Mechanism"

    @property
    def frame_name(self) -> str:
        return "ground"

    def frame(
        self,
        name: str,
        position: ArrayLike = (0.0, 0.0, 0.0),
        rotation: ArrayLike = (0.0, 0.0, 0.0),
    ) -> FrameHandle:
        """Add a frame that is fixed in space.

        Parameters
        ----------
        name : str
        position : (3,) [m]
        rotation : (3,) [rad]
            Rotation vector of its axes.
        """
        self.mechanism.ground_frames[name] = solver.Frame(position, rotation)
        return self[name]

    def __getitem__(self, frame: str) -> FrameHandle:
        return _frame(self.mechanism, "ground", frame, tuple(self.mechanism.ground_frames))

    def __repr__(self) -> str:
        return f"<ground, frames: {', '.join(self.mechanism.ground_frames) or 'none'}>"


def _frame(mechanism: "Mechanism", body: str, frame: str, known: Sequence[str]) -> FrameHandle:
    if frame not in known:
        raise solver.ModelError(
            f"no frame {quoted(frame)} on {body!r}; it has: {', '.join(known) or 'none'}"
        )
    return FrameHandle(_Owned(f"{body}.{frame}", mechanism))


class Mechanism:
    """Bodies, joints, loads, springs, contacts, motors: what a simulation moves.

    Parameters
    ----------
    gravity : (3,) [m/s^2]
        The acceleration of a free body.

    Examples
    --------
    A pendulum of a point-like mass, released at an angle:

    >>> import duhamel as du
    >>> m = du.Mechanism(gravity=[0.0, 0.0, -9.81])
    >>> bob = m.add(du.RigidBody(1.0, [1e-3] * 3, {"pin": [0.0, 0.0, 0.5]}), name="bob")
    >>> hinge = m.add(du.joints.Revolute(m.ground, bob["pin"], axis="y", start={"angle": 0.1}))
    >>> hinge.name
    'revolute 1'
    >>> run = m.simulate(0.1, step=1e-3)
    >>> round(float(run["revolute 1"].angle[-1]), 3)
    0.09
    """

    def __init__(self, gravity: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        self.gravity = gravity
        self.bodies: dict[str, Body] = {}
        self.ground_frames: dict[str, solver.Frame] = {}
        self.settings = solver.Settings(t_end=1.0)
        """from which each simulation begins: those of the model file, if there is one"""
        self._last = self.settings
        self._entries: dict[str, tuple[Any, ...]] = dict.fromkeys(MODEL_GROUPS, ())
        self._path = ""

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Self:
        """The mechanism of a model file, with its settings; `ModelError` names file and key."""
        return cls._of(solver.read_model(path))

    @classmethod
    def _of(cls, model: solver.Model) -> Self:
        made = cls(model.gravity)
        made.bodies, made.ground_frames = dict(model.bodies), dict(model.ground_frames)
        made.settings = made._last = model.settings
        made._path = model.path
        made._entries = {group: getattr(model, group) for group in MODEL_GROUPS}
        made._entries["contacts"] += model.surface_contacts
        return made

    def copy(self) -> Self:
        """A mechanism that changes apart from this one; what it is made of is shared."""
        made = copy(self)
        made.bodies, made.ground_frames = dict(self.bodies), dict(self.ground_frames)
        made._entries = dict(self._entries)
        return made

    @property
    def ground(self) -> GroundHandle:
        """Space, as a body to which others are joined."""
        return GroundHandle(self)

    def __getitem__(self, name: str) -> Any:
        """A body as its handle, or a joint, spring, contact, ... as it was added, by name."""
        if name in self.bodies:
            return BodyHandle(self, _Owned(name, self))
        named = {entry.name: entry for entry in self._named()}
        if name not in named:
            known = ", ".join([*self.bodies, *named]) or "none"
            raise solver.ModelError(f"nothing is named {quoted(name)}; there are: {known}")
        return named[name]

    def __repr__(self) -> str:
        counts = {group: len(entries) for group, entries in self._entries.items()}
        named = ", ".join(self.bodies) or "none"
        parts = [
            f"{count} {group if count > 1 else group.removesuffix('s')}"
            for group, count in counts.items()
            if count
        ]
        return f"<Mechanism: {'; '.join([f'bodies {named}', *parts])}>"

    @overload
    def add(
        self,
        what: Superelement | AnyRigidBody | solver.FlexibleBody | str | os.PathLike[str],
        name: str = "",
        *,
        position: ArrayLike | None = None,
        rotation: ArrayLike | None = None,
        place: Mapping[str, str | Framed] | None = None,
        velocity: ArrayLike | None = None,
        angular_velocity: ArrayLike | None = None,
        rigid: bool = False,
        second_order: Literal["auto", "full", "off"] = "auto",
    ) -> BodyHandle: ...
    @overload
    def add(self, what: AnyPart, name: str = "") -> AnyPart: ...
    def add(
        self,
        what: Any,
        name: str = "",
        *,
        position: ArrayLike | None = None,
        rotation: ArrayLike | None = None,
        place: Mapping[str, str | Framed] | None = None,
        velocity: ArrayLike | None = None,
        angular_velocity: ArrayLike | None = None,
        rigid: bool = False,
        second_order: Literal["auto", "full", "off"] = "auto",
    ) -> Any:
        """Add a body, or what acts between bodies.

        Parameters
        ----------
        what
            A `Superelement` or the path of its file, a `RigidBody`; or a joint, spring, load,
            contact, stop, motor, coupler, motion, bearing or FMU, which take no other argument
            than `name`.
        name : str
            By which results know it. Without one bodies have that of their part, and the rest is
            numbered, as "revolute 2".
        position : (3,) [m]
            Of the center of mass of a body at the start, in space.
        rotation : (3,) [rad]
            Rotation vector of its axes.
        place : {FRAME: frame}
            Instead of both: a frame of the body by name and that of another with which it
            coincides, axes included, as `{"root": hub["rim"]}`; "" is the center of mass.
        velocity : (3,) [m/s]
            Of the center of mass, in space.
        angular_velocity : (3,) [rad/s]
            In body axes.
        rigid : bool
            Leave the elasticity of a superelement out.
        second_order : {"auto", "full", "off"}
            Whether terms of fast rotation and large loads are used, where a superelement has them.

        Returns
        -------
        BodyHandle, or the entry with its name
            `handle["tip"]` is a frame for joints and loads; joints go to motors, stops, couplers.
        """
        start = {
            "position": position,
            "rotation": rotation,
            "place": None if place is None else _place(place),
            "velocity": velocity,
            "angular_velocity": angular_velocity,
        }
        given = {key: value for key, value in start.items() if value is not None}
        if (group := getattr(what, "group", None)) in MODEL_GROUPS:
            if given or rigid or second_order != "auto":
                raise solver.ModelError(
                    f"{what.owner}: expected no start, found {', '.join(given) or 'rigid'}: bodies "
                    "alone take it"
                )
            return self._add_entry(str(group), what, name)
        return self._add_body(_body(what, given, rigid, second_order), name)

    def model(self, settings: solver.Settings | None = None) -> solver.Model:
        """The mechanism as the solver takes it; `ModelError` says what is wrong with it."""
        entries: dict[str, Any] = {**self._entries}
        contacts = entries["contacts"]
        of_surfaces = tuple(one for one in contacts if one.presses_surfaces)
        entries["contacts"] = tuple(one for one in contacts if not one.presses_surfaces)
        return solver.Model(
            bodies=dict(self.bodies),
            gravity=self.gravity,
            ground_frames=dict(self.ground_frames),
            settings=settings or self.settings,
            path=self._path,
            surface_contacts=of_surfaces,
            **entries,
        )

    def simulate(
        self,
        t_end: float | None = None,
        step: float | None = None,
        *,
        output: str | os.PathLike[str] | None = None,
        progress: bool = False,
        resume: bool = False,
        **settings: Any,
    ) -> Run:
        """Integrate the motion from t = 0.

        Parameters
        ----------
        t_end : float [s]
            By default that of the model file, or 1 s.
        step : float [s]
            By default that of the superelements.
        output : path
            A results file, which `Run.read` reads; without one the run is in memory.
        progress : bool
            Show a bar with the remaining time.
        resume : bool
            Go on from the checkpoint beside `output`.
        **settings
            Fields of `duhamel.solver.Settings`: contact_step, rho_inf, start="equilibrium",
            steady_rotation, checkpoint, output=OutputRequest(...) as `record`, ...

        Returns
        -------
        Run
            `run["hinge"].angle`, `run.plot(...)`, `run.animate(...)`.

        Raises
        ------
        ModelError, ConvergenceError, OutOfRangeError, MissedContactError
        """
        self._last = self._settings(t_end, step, settings)
        model = self.model(self._last)
        return Run(solver.simulate(model, output=output, progress=progress, resume=resume))

    def simulator(
        self,
        outputs: Sequence[str] = (),
        t_end: float | None = None,
        step: float | None = None,
        *,
        results: str | os.PathLike[str] | None = None,
        **settings: Any,
    ) -> solver.Simulator:
        """A simulation step by step, for controllers: see `duhamel.solver.Simulator`."""
        self._last = self._settings(t_end, step, settings)
        return solver.Simulator(self.model(self._last), outputs, results=results)

    def export_fmu(
        self,
        path: str | os.PathLike[str],
        t_end: float | None = None,
        step: float | None = None,
        *,
        outputs: Sequence[str] = (),
        parameters: Sequence[str] = (),
        communication: float | None = None,
        platforms: Sequence[str] = (),
        version: int = 3,
        cpu: str = "x86-64-v3",
        **settings: Any,
    ) -> "fmu.ExportedModel":
        """Write an FMU, which other programs step without Python: see `duhamel.fmu.export_fmu`.

        t_end, step and settings are those of `simulate`; signals `du.signals.Input` are inputs.
        """
        from duhamel import fmu  # a simulation needs none of it

        self._last = self._settings(t_end, step, settings)
        return fmu.export_fmu(
            self.model(self._last),
            path,
            outputs=outputs,
            parameters=parameters,
            communication=communication,
            platforms=platforms,
            version=version,
            cpu=cpu,
        )

    def sensitivities(
        self,
        parameters: Mapping[str, "AnyParameter"],
        outputs: Mapping[str, str] | Sequence[str],
        t_end: float | None = None,
        step: float | None = None,
        *,
        scales: Mapping[str, float] | None = None,
        method: str = "differences",
        **settings: Any,
    ) -> "study.Sensitivities":
        """Derivatives of outputs of a run by parameters, see `duhamel.study.sensitivities`.

        Parameters
        ----------
        parameters : mapping of str or Parameter
            By names of your own: keys of the model file, as "bodies.hub.mass", or
            `du.Parameter(change, start=...)` with a function `change(mechanism, value)`, which
            gets a copy of the mechanism.
        outputs : mapping or sequence of str
            "max |hinge.moment|", "final rod.tip.position.z", or a quantity over time.
        t_end, step, **settings
            Those of `simulate`.
        scales : mapping of float, optional
            The sizes by which steps are counted, of parameters that are 0.
        method : {"differences", "dual"}
            By runs beside these values, or by one run with dual numbers.

        Returns
        -------
        Sensitivities

        Raises
        ------
        StudyError

        Examples
        --------
        >>> import duhamel as du
        >>> m = du.Mechanism(gravity=[0.0, 0.0, -10.0])
        >>> ball = m.add(du.RigidBody(2.0, [0.1] * 3), name="ball")
        >>> def push(m, force):
        ...     m.add(du.loads.Force(m["ball"], "z", du.signals.Constant(force)))
        >>> found = m.sensitivities(
        ...     {"g": "simulation.gravity.2", "force": du.Parameter(push, start=8.0)},
        ...     {"end": "final ball.position.z"},
        ...     step=0.1,
        ... )
        >>> found.derivative.round(6).tolist()
        [[0.5, 0.25]]
        """
        from duhamel import study  # a simulation needs none of it

        varied = self._varied(parameters, t_end, step, settings)
        named = outputs if isinstance(outputs, Mapping) else {text: text for text in outputs}
        return study.sensitivities(
            varied.make,
            {name: one.start or 0.0 for name, one in varied.parameters.items()},
            {name: varied.output(text) for name, text in named.items()},
            scales=scales,
            method=method,
        )

    def fit(
        self,
        parameters: Mapping[str, "AnyParameter"],
        series: Mapping[str, tuple[ArrayLike, ArrayLike]],
        t_end: float | None = None,
        step: float | None = None,
        *,
        sigma: float | Mapping[str, float] | None = None,
        shift: bool = False,
        derivatives: str = "differences",
        **settings: Any,
    ) -> "study.ModelFit":
        """Fit parameters to measured series, see `duhamel.study.fit_model`.

        Parameters
        ----------
        parameters : mapping of str or Parameter
            As of `sensitivities`; `du.Parameter(key, bounds=(low, high))` has bounds.
        series : mapping of (time, values)
            By quantities, as "rod.tip.position.z": times [s] and values (n,).
        t_end, step, **settings
            Those of `simulate`.
        sigma : float or mapping of float, optional
            The standard deviation of the noise.
        shift : bool
            Whether the time of the series may be shifted.
        derivatives : {"differences", "dual"}
            By two runs for each parameter, or by one run with dual numbers.

        Returns
        -------
        ModelFit
            `with_values(parameters, found.values)` is the mechanism that was fitted.

        Raises
        ------
        StudyError

        Examples
        --------
        >>> import duhamel as du
        >>> import numpy as np
        >>> m = du.Mechanism(gravity=[0.0, 0.0, -10.0])
        >>> ball = m.add(du.RigidBody(2.0, [0.1] * 3), name="ball")
        >>> t = np.linspace(0.0, 1.0, 11)
        >>> found = m.fit(
        ...     {"g": du.Parameter("simulation.gravity.2", bounds=(-20.0, 0.0))},
        ...     {"ball.position.z": (t, -9.81 * t**2 / 2)},
        ...     step=0.1,
        ... )
        >>> round(found.values["g"], 6)
        -9.81
        """
        from duhamel import study

        varied = self._varied(parameters, t_end, step, settings)
        return study.fit_model(
            varied.make,
            varied.parameters,
            {self.quantity(name): measured for name, measured in series.items()},
            sigma={self.quantity(name): one for name, one in sigma.items()}
            if isinstance(sigma, Mapping)
            else sigma,
            shift=shift,
            derivatives=derivatives,
        )

    def optimize(
        self,
        parameters: Mapping[str, "AnyParameter"],
        outputs: Mapping[str, str] | None = None,
        t_end: float | None = None,
        step: float | None = None,
        *,
        minimize: str | None = None,
        maximize: str | None = None,
        constraints: Mapping[str, tuple[float | None, float | None]] | None = None,
        method: Literal["local", "global"] = "local",
        runs: int = 1000,
        seed: int = 0,
        derivatives: str = "differences",
        **settings: Any,
    ) -> "study.Optimum":
        """Find the parameters for which an output is least or largest within limits.

        Parameters
        ----------
        parameters : mapping of str or Parameter
            As of `sensitivities`; `du.Parameter(key, bounds=(low, high))` has bounds.
        outputs : mapping of str
            By name, for `minimize` and `constraints`.
        t_end, step, **settings
            Those of `simulate`.
        minimize, maximize : str
            One of them: the name of an output, an output, or arithmetic of outputs and parameters.
        constraints : mapping of (low, high)
            Of what `minimize` takes, None where there is no limit.
        method : {"local", "global"}
            "global" looks in all of the bounds first.
        runs : int
            How many it may make.
        seed : int
            Of the random numbers of a global search.
        derivatives : {"differences", "dual"}
            By two runs for each parameter, or by one run with dual numbers.

        Returns
        -------
        Optimum
            `with_values(parameters, found.values)` is the best mechanism. See
            `duhamel.study.optimize_model`.

        Raises
        ------
        StudyError

        Examples
        --------
        >>> import duhamel as du
        >>> m = du.Mechanism(gravity=[0.0, 0.0, -10.0])
        >>> ball = m.add(du.RigidBody(2.0, [0.1] * 3), name="ball")
        >>> push = m.add(du.loads.Force(ball, "z", du.signals.Constant(5.0)))
        >>> found = m.optimize(
        ...     {"force": du.Parameter("loads.0.signal", bounds=(0.0, 50.0))},
        ...     {"end": "final ball.position.z"},
        ...     step=0.1,
        ...     minimize="force",
        ...     constraints={"end": (1.0, None)},
        ... )
        >>> found.converged, round(found.values["force"], 6)
        (True, 24.0)
        """
        from duhamel import study

        varied = self._varied(parameters, t_end, step, settings)
        return study.optimize_model(
            varied.make,
            varied.parameters,
            {name: varied.output(text) for name, text in (outputs or {}).items()},
            minimize=None if minimize is None else varied.goal(minimize),
            maximize=None if maximize is None else varied.goal(maximize),
            constraints={varied.goal(text): ends for text, ends in (constraints or {}).items()},
            method=method,
            runs=runs,
            seed=seed,
            derivatives=derivatives,
        )

    def with_values(
        self, parameters: Mapping[str, "AnyParameter"], values: Mapping[str, float]
    ) -> Self:
        """The mechanism with values of the parameters of a fit or a search.

        Parameters
        ----------
        parameters : mapping of str or Parameter
            As they were given.
        values : mapping of float
            As `found.values`.

        Examples
        --------
        >>> import duhamel as du
        >>> m = du.Mechanism()
        >>> ball = m.add(du.RigidBody(2.0, [0.1] * 3), name="ball")
        >>> m.with_values({"m": "bodies.ball.mass"}, {"m": 3.0}).bodies["ball"].mass
        3.0
        """
        from .varied import VariedMechanism

        return self._of(
            VariedMechanism(self, parameters, self._settings(None, None, {})).at(values)
        )

    def _varied(
        self,
        parameters: Mapping[str, "AnyParameter"],
        t_end: float | None,
        step: float | None,
        settings: dict[str, Any],
    ) -> "VariedMechanism":
        from .varied import VariedMechanism  # a simulation needs none of it

        self._last = self._settings(t_end, step, settings)
        return VariedMechanism(self, parameters, self._last)

    def check(
        self, t_end: float | None = None, step: float | None = None, **settings: Any
    ) -> solver.ModelCheck:
        """What a run would be: degrees of freedom, frequencies, damping, time, memory, warnings.

        The parameters are those of `simulate`.
        """
        return solver.check(self.model(self._settings(t_end, step, settings)))

    def linear(self, angular_velocity: ArrayLike | None = None) -> solver.LinearModel:
        """The linear equations about the equilibrium, at rest or in a steady rotation [rad/s]."""
        rotation = None if angular_velocity is None else solver.SteadyRotation(angular_velocity)
        return solver.linearize(self.model(), rotation)

    def modes(
        self, n: int | None = 12, angular_velocity: ArrayLike | None = None
    ) -> solver.LinearModes:
        """The first n natural modes about the equilibrium: `.frequencies` [Hz], `.ratios`."""
        return self.linear(angular_velocity).modes(n)

    def frf(
        self,
        inputs: Sequence[str],
        outputs: Sequence[str],
        frequencies: ArrayLike,
        bodies: Literal["dynamic", "static", "rigid"] = "dynamic",
    ) -> solver.FrequencyResponse:
        """Frequency responses of outputs to inputs at frequencies (n,) [Hz].

        Parameters
        ----------
        inputs : list of str
            "force:rod.tip:y", "torque:rod:z", "load:1", "drive:hinge", or the name of an `Input`.
        outputs : list of str
            Quantities as `Run.plot` takes them, as "rod.tip.position.y".
        frequencies : (n,) [Hz]
        bodies : {"dynamic", "static", "rigid"}
            How flexible bodies deform.
        """
        named = [self.quantity(output) for output in outputs]
        return self.linear().frf(inputs, named, frequencies, bodies)

    def campbell(
        self,
        spins: ArrayLike,
        axis: ArrayLike | str | None = None,
        center: ArrayLike = (0.0, 0.0, 0.0),
        n: int = 8,
        progress: bool = False,
    ) -> solver.Campbell:
        """The first n natural frequencies over the speed of a steady rotation.

        Parameters
        ----------
        spins : (m,) [rad/s]
            Increasing; drives that turn the mechanism follow them.
        axis, center : (3,), (3,) [m]
            Of the rotation, in space. By default those of the first bearing, or z.
        n : int
        progress : bool
            Show how far it is.
        """
        model = self._turning(axis, center)
        return solver.campbell(model, np.asarray(spins).tolist(), n, progress)

    def unbalance(
        self, at: Mapping[Any, complex], spins: ArrayLike, progress: bool = False
    ) -> solver.UnbalanceResponse:
        """The orbits of a rotor on bearings under unbalance, over its spin.

        Parameters
        ----------
        at : mapping of complex [kg m]
            Mass times eccentricity by frames of the shaft, at an angle from e_1 to e_2.
        spins : (m,) [rad/s]
            Increasing.
        progress : bool
            Show how far it is.
        """
        given = {frame_name(frame): complex(value) for frame, value in at.items()}
        model = self._turning(None, np.zeros(3))
        return solver.unbalance_response(model, given, np.asarray(spins).tolist(), progress)

    def stability(
        self, spins: ArrayLike, n: int = 12, progress: bool = False
    ) -> solver.StabilityMap:
        """The growth of the least damped of the first n modes of a rotor on bearings, over its
        spin [rad/s], and the speeds at which stability changes.
        """
        model = self._turning(None, np.zeros(3))
        return solver.stability_map(model, np.asarray(spins).tolist(), n, progress)

    def _turning(self, axis: ArrayLike | str | None, center: ArrayLike) -> solver.Model:
        """The model in a steady rotation about an axis, or about that of its bearings."""
        rotation = None
        if axis is not None or not self._entries["bearings"]:
            rotation = solver.SteadyRotation(direction("z" if axis is None else axis), center)
        settings = replace(self.settings, start="equilibrium", steady_rotation=rotation)
        return self.model(settings)

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write a model file that `duhamel run` and `Mechanism.read` take.

        Superelements in memory are written beside it, as MODEL-BODY.h5. The settings are those of
        the last simulation.
        """
        path = Path(path)
        model = self.model(self._last)
        bodies = dict(model.bodies)
        for name, body in bodies.items():
            if not isinstance(body, solver.RigidBody) and not body.source:
                beside = path.with_name(f"{path.stem}-{name}.h5")
                superelement.write(body.superelement.base, beside)
                bodies[name] = replace(body, source=str(beside))
        self.bodies = bodies
        solver.write_model(replace(model, bodies=bodies), path)

    def draw(self, path: str | os.PathLike[str], **options: Any) -> Path:
        """Draw the mechanism at its start, as .png.

        Parameters
        ----------
        path
        **options
            Those of `duhamel.view.animate`: field, size, view, marks, title.
        """
        view.animate(solver.start(self.model()), path, at=0.0, **({"field": "none"} | options))
        return Path(path)

    def _repr_html_(self) -> str:
        """Its table, below a picture of its start where PyVista is installed and it can start."""
        if not self.bodies:
            return "<p>Mechanism without bodies</p>"
        table = self.model()._repr_html_()
        with tempfile.TemporaryDirectory() as folder:
            try:
                png = self.draw(Path(folder) / "start.png", size=(960, 540)).read_bytes()
            except (view.PictureError, solver.ModelError):
                return table
        return embedded(png) + table

    def _settings(
        self, t_end: float | None, step: float | None, more: dict[str, Any]
    ) -> solver.Settings:
        if "record" in more:
            more["output"] = more.pop("record")
        changes = more | {"t_end": t_end, "step": step}
        known = solver.Settings.__dataclass_fields__
        if unknown := sorted(set(changes) - set(known)):
            raise solver.ModelError(
                f"simulate: unknown setting {unknown[0]!r}; known are {', '.join(known)}"
            )
        return replace(
            self.settings, **{key: value for key, value in changes.items() if value is not None}
        )

    def quantity(self, text: str) -> str:
        """A quantity as `duhamel plot` names it, from "rod.tip.position.y" and the like."""
        frames = [f"{name}.{frame}" for name, body in self.bodies.items() for frame in body.frames]
        joints = {joint.name: joint.coordinates for joint in self._entries["joints"]}
        owners = [*self.bodies, *frames, *(entry.name for entry in self._named())]
        return quantity_of(text, KINDS_BY_NAME, owners, lambda owner: joints.get(owner, ()))

    def _named(self) -> Iterable[Any]:
        return (
            entry
            for entries in self._entries.values()
            for entry in entries
            if hasattr(entry, "name")
        )

    def _add_body(self, body: Body, name: str) -> BodyHandle:
        name = name or _name_of(body)
        if not name:
            numbers = (f"body{k}" for k in range(1, len(self.bodies) + 2))
            name = next(free for free in numbers if free not in self.bodies)
        if name in self.bodies:
            raise solver.ModelError(f"bodies: a body named {quoted(name)} is there already")
        if name in {entry.name for entry in self._named()}:
            raise solver.ModelError(f"bodies: {quoted(name)} is there already, and no body")
        if name == "ground" or not is_name(name):
            raise solver.ModelError(
                f"bodies: a body cannot be named {quoted(name)}: expected {FORM_OF_NAMES}, other "
                "than 'ground'"
            )
        self._check_owners(f"body {name!r}", body.start.place)
        self.bodies[name] = body
        return BodyHandle(self, _Owned(name, self))

    def _check_owners(self, owner: str, entry: Any) -> None:
        """`ModelError` where a field of an entry came from a handle of another mechanism.

        Its own name does not count: it gets another one here.
        """
        fields = {} if entry is None else vars(entry)
        for field, value in fields.items():
            if field == "name":
                continue
            for name in value if isinstance(value, tuple) else (value,):
                if isinstance(name, _Owned) and name.mechanism is not self:
                    raise solver.ModelError(
                        f"{owner}: {quoted(str(name))} is of another mechanism, "
                        f"{name.mechanism!r}, not of this one, {self!r}"
                    )

    def _add_entry(self, group: str, entry: Any, name: str) -> Any:
        if name:
            if not hasattr(entry, "name"):
                raise solver.ModelError(f"{entry.owner}: expected no name, found {quoted(name)}")
            entry = replace(entry, name=name)
        self._check_owners(entry.owner, entry)
        entries = (*self._entries[group], entry)
        if hasattr(entry, "name"):
            taken = {other.name for other in self._named()}
            if entry.name in taken or entry.name in self.bodies:
                raise solver.ModelError(f"{group}: {quoted(entry.name)} is there already")
            *others, entry = numbered(group.removesuffix("s"), entries, taken)
            entries = (*others, replace(entry, name=_Owned(entry.name, self)))
        self._entries[group] = entries
        return entries[-1]


def _place(given: Mapping[str, str | Framed]) -> Place:
    if len(given) != 1:
        raise solver.ModelError(f"place: expected {{FRAME: frame}}, found {quoted(given)}")
    ((frame, on),) = given.items()
    return Place(frame, on)


def _name_of(body: Body) -> str:
    """That of its superelement, if it may be one."""
    own = getattr(body, "superelement", None)
    return own.name if own is not None and is_name(own.name) else ""


def _body(
    what: Any, start: dict[str, Any], rigid: bool, second_order: Literal["auto", "full", "off"]
) -> Body:
    if isinstance(what, AnyRigidBody | solver.FlexibleBody):
        return replace(what, start=replace(what.start, **start)) if start else what
    source = ""
    if isinstance(what, str | os.PathLike):
        source = str(what)
        what = superelement.read(source, recovery=False)
    if isinstance(what, Superelement):
        if rigid:
            return solver.RigidSuperelement(what, Start(**start), source)
        return solver.FlexibleBody(what, Start(**start), source, second_order)
    if isinstance(what, Part):
        raise solver.ModelError(
            f"part {what.name!r}: expected its superelement: add(part.superelement(step=...))"
        )
    raise solver.ModelError(
        "expected a Superelement, a RigidBody, or a joint, load, spring, contact, stop, motor, "
        f"coupler, motion, bearing or FMU, found {quoted(what)}"
    )
