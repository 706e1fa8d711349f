"""What a state belongs to: the model by its keys, superelements, versions, and numbers of a step.

A state goes on to the bit where all of this is the same. `t_end` is not among it, nor what does not
touch the numbers.
"""

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from importlib import metadata
from typing import Any

import numpy as np

from ...superelement import Superelement
from ..arrays import Array
from ..compiler.digests import key as code_key
from ..compiler.digests import processor
from ..compiler.object_file import compiler
from ..errors import StateError
from ..history.layout import Horizon
from ..laws.law import LAW_KINDS
from ..lower.lower import LoweredModel
from ..model.bodies import FlexibleBody, RigidBody, RigidSuperelement
from ..model.fmus import FMU
from ..model.model import Model
from ..schema.entry import Entry, Flattened, note
from ..schema.tables import declared, key_of
from ..signals.recorded import Recorded, RecordedSpline
from ..step.records.laws import Laws
from .layout import Layout, layout_of

FREE_KEYS = ("simulation.t_end", "simulation.checkpoint", "source", "path")
"""beginnings of keys that may change between a run and its continuation"""
KEY_OF_FIELD = {
    "settings": "simulation",
    "ground_frames": "ground.frames",
    "gravity": "simulation.gravity",
}
"""fields of a model by the keys of files"""
# Other versions may round otherwise, and a run would not go on to the bit.
NUMERICAL_LIBRARIES = ("numpy", "scipy", "numba", "llvmlite")
BESIDES_THE_NUMBERS = frozenset({"recovery", "provenance", "outline", "derivatives", "variation"})
"""fields of superelements that no step reads"""
SHAPE_FIELD = "shape"
"""the field of rigid bodies that no step reads"""
# characters in a message
MAX_QUOTED_VALUE = 60


@dataclass(frozen=True)
class Identity:
    """software: versions by name; model: values by key; system: digests of a step's data by name.

    kernels: of each body whose loads are convolved, the form, the lags, 1 if it is cut off, and a
    digest; horizon: the numbers of steps that it was planned and laid out for; layout: its names.
    """

    software: Mapping[str, str]
    model: Mapping[str, Any]
    system: Mapping[str, str]
    kernels: Mapping[str, tuple[str, int, bool, str]]
    horizon: Horizon
    layout: Layout

    def to_text(self) -> str:
        return json.dumps({field.name: getattr(self, field.name) for field in fields(self)})

    @classmethod
    def from_text(cls, text: str) -> "Identity":
        """`StateError` for a text that is none."""
        try:
            values = json.loads(text)
            kernels = {name: tuple(kernel) for name, kernel in values.pop("kernels").items()}
            horizon = Horizon(*map(int, values.pop("horizon")))
            layout = Layout(*values.pop("layout"))
            return cls(kernels=kernels, horizon=horizon, layout=layout, **values)
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
            raise StateError(f"identity: not readable: {error}") from error

    def check_model(self, model: Model) -> None:
        """`StateError` that names what has changed in versions, machine and model."""
        # The state has been through JSON: tuples are lists there, on both sides now.
        is_now = json.loads(json.dumps(contents_of(model)))
        if change := first_change(self.software, software()) or first_change(self.model, is_now):
            raise StateError(change)

    def changed_joints(self, model: Model) -> set[str]:
        """The names of joints and prescribed motions that are declared in another way now."""
        was, now = self.model, json.loads(json.dumps(contents_of(model)))
        keys = (key.split(".") for key in {**was, **now} if was.get(key) != now.get(key))
        return {key[1] for key in keys if key[0] in ("joints", "motions")}

    def check_steps(self, lowered: LoweredModel) -> None:
        """`StateError` for another number of steps."""
        if self.horizon != lowered.horizon:
            raise StateError(f"t_end: was {self.horizon.steps} steps, is {lowered.horizon.steps}")

    def check_system(self, lowered: LoweredModel) -> None:
        """`StateError` for numbers that the same model had not, or kernels of a longer run."""
        if change := first_change(self.system, _system(lowered)):
            raise StateError(
                f"the data of a step differ: {change}: other libraries of linear algebra, or "
                "another number of threads"
            )
        self.check_kernels(lowered, self.kernels)

    def check_kernels(self, lowered: LoweredModel, bodies: Iterable[str]) -> None:
        """`StateError` for another history of one of the bodies."""
        now = {name: e for e, name in _convolved(lowered)}
        for name in bodies:
            if name not in self.kernels and name not in now:
                continue
            if name not in self.kernels:
                raise StateError(f"body {name!r}: its history was recursive, is not now")
            if name not in now:
                raise StateError(f"body {name!r}: its history was not recursive, is now")
            _check_kernel(name, self.kernels[name], now[name], lowered)


def identity_of(lowered: LoweredModel) -> Identity:
    return Identity(
        software=software(),
        model=json.loads(json.dumps(contents_of(lowered.model))),
        system=_system(lowered),
        kernels={name: _kernel(e, lowered) for e, name in _convolved(lowered)},
        horizon=lowered.horizon,
        layout=layout_of(lowered),
    )


def first_change(was: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """The first key with another value, in words; "" if there is none."""
    # In the order of the file, so that the first change is the one a user finds first.
    for key in [*was, *(key for key in now if key not in was)]:
        if key not in now:
            return f"{key}: was {_short(was[key])}, is no longer there"
        if key not in was:
            return f"{key}: was not there, is {_short(now[key])}"
        if was[key] != now[key]:
            return f"{key}: was {_short(was[key])}, is {_short(now[key])}"
    return ""


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= MAX_QUOTED_VALUE else f"{text[: MAX_QUOTED_VALUE - 3]}..."


def software() -> dict[str, str]:
    """Versions of what computes, the processor, and the compiled code."""
    names = ("duhamel", *NUMERICAL_LIBRARIES)
    return {name: metadata.version(name) for name in names} | {
        "processor": processor(),
        "code of the time step": code_key(),
        "compiler of the time step": compiler(),
    }


# The model


def contents_of(model: Model) -> dict[str, Any]:
    """The values of a model by the keys of its file, but for those that may change."""
    contents: dict[str, Any] = {}
    for field, _ in declared(Model):
        key = KEY_OF_FIELD.get(field.name, field.name)
        contents |= _flat(key, getattr(model, field.name))
    return {key: value for key, value in contents.items() if not key.startswith(FREE_KEYS)}


def _flat(key: str, value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, FlexibleBody):
        yield f"{key}.superelement", digest_of(value.superelement)
        yield f"{key}.second_order", value.rotation is not None
        yield from _flat(key, value.start)
    elif isinstance(value, RigidSuperelement):
        yield f"{key}.superelement", digest_of(value.superelement)
        yield f"{key}.rigid", True
        yield from _flat(key, value.start)
    elif isinstance(value, Recorded | RecordedSpline):
        # wherever the file is, and whatever else is in it
        yield f"{key}.file", f"{type(value).__name__} {digest_of(value.points)}"
    elif isinstance(value, Entry):
        for field, hint in declared(type(value)):
            if isinstance(value, RigidBody) and field.name == SHAPE_FIELD:
                continue
            if isinstance(value, FMU) and field.name == "file":
                yield f"{key}.file", value.digest
                continue
            below = key if note(hint, Flattened) else f"{key}.{key_of(field, hint)}"
            yield from _flat(below, getattr(value, field.name))
    elif isinstance(value, Mapping):
        for name, item in value.items():
            yield from _flat(f"{key}.{name}", item)
    elif isinstance(value, tuple) and any(isinstance(item, Entry) for item in value):
        for number, item in enumerate(value, start=1):
            yield from _flat(f"{key}.{getattr(item, 'name', number)}", item)
    else:
        yield key, _plain(value)


def _plain(value: Any) -> Any:
    """A value as JSON has it; of a Python function its name."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Callable):  # type: ignore[arg-type]
        return f"function {getattr(value, '__qualname__', type(value).__qualname__)}"
    # Of a Python function only the name is known: its code may change unnoticed.
    return value if isinstance(value, str | int | float | bool | tuple | None) else repr(value)


def digest_of(value: Any) -> str:
    """A digest of the numbers and names in a superelement."""
    digest = hashlib.blake2b(digest_size=16)
    for part in _parts(value):
        digest.update(part)
    return digest.hexdigest()


def _parts(value: Any) -> Iterator[bytes]:
    if is_dataclass(value):
        for field in fields(value):
            if not (isinstance(value, Superelement) and field.name in BESIDES_THE_NUMBERS):
                yield field.name.encode()
                yield from _parts(getattr(value, field.name))
    elif isinstance(value, np.ndarray):
        # Bytes alone would make arrays of other shapes equal.
        yield repr((value.dtype.str, value.shape)).encode()
        yield np.ascontiguousarray(value).tobytes()
    elif isinstance(value, tuple):
        for item in value:
            yield from _parts(item)
    else:
        yield repr(value).encode()


# The numbers of a step


def _system(lowered: LoweredModel) -> dict[str, str]:
    """Digests of all that a step reads, but for kernels, whose lags depend on t_end."""
    leaves = dict(lowered.system.leaves())
    leaves["couplings/laws/parameters"] = _without_addresses(lowered.system.couplings.laws)
    return {
        name: digest_of(value)
        for name, value in leaves.items()
        if not name.startswith("elastic/kernels/")
    }


def _without_addresses(laws: Laws) -> Array:
    """The parameters of force laws, with 0 for what is another number in every process."""
    parameters = laws.parameters.copy()
    for first, number in zip(laws.first.tolist(), laws.number.tolist(), strict=False):
        # Laws of users are called by their address, which each process chooses anew.
        parameters[first : first + LAW_KINDS[number].addresses] = 0.0
    return parameters


def _convolved(lowered: LoweredModel) -> list[tuple[int, str]]:
    lags = lowered.system.elastic.kernels.lags
    return [(e, name) for e, name in enumerate(lowered.model.flexible_bodies) if lags[e]]


def _kernel(e: int, lowered: LoweredModel, lags: int | None = None) -> tuple[str, int, bool, str]:
    """Form, lags, whether it is cut off, and a digest of its first lags, by default of all."""
    kernels = lowered.system.elastic.kernels
    own = int(kernels.lags[e])
    lags = own if lags is None else lags
    form = "fft" if kernels.by_fft[e] else "direct"
    g, g_initial = kernel_arrays(e, lowered)
    first = tuple(np.ascontiguousarray(array[:lags]) for array in (g, g_initial))
    return form, lags, own <= lowered.horizon.steps, digest_of(first)


def kernel_arrays(e: int, lowered: LoweredModel) -> tuple[Array, Array]:
    """g and g_initial of a flexible body (lags, n_c, n_c), from the first lag on."""
    elastic = lowered.system.elastic
    n_c = int(elastic.dof[e + 1] - elastic.dof[e])
    start, lags = int(elastic.kernels.g_start[e]), int(elastic.kernels.lags[e])
    numbers = slice(start, start + n_c * n_c * lags)
    g = elastic.kernels.g[numbers].reshape(n_c, n_c, lags)[:, :, ::-1].transpose(2, 0, 1)
    return g, elastic.kernels.g_initial[numbers].reshape(lags, n_c, n_c)


def _check_kernel(
    name: str, was: tuple[str, int, bool, str], e: int, lowered: LoweredModel
) -> None:
    now = _kernel(e, lowered, was[1])
    if was[0] != now[0]:
        raise StateError(f"body {name!r}: its history was {was[0]}, is {now[0]}")
    # A longer run may cut kernels off that were whole before; that alone would be no reason.
    if was[2] != now[2] and was[3] != now[3]:
        raise StateError(
            f"body {name!r}: memory: its impulse responses are truncated in the longer run only"
        )
    if was[3] != now[3]:
        raise StateError(
            f"body {name!r}: the first {was[1]} lags of its impulse responses differ in the "
            "longer run: its superelement holds too few of them"
        )
