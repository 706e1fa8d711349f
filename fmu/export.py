"""A model as a file that importers of FMI step without Python."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..files.outputs import renamed_when_whole, require_no_input
from ..solver.compiler.object_file import object_files
from ..solver.compiler.targets import own_platform
from ..solver.errors import about
from ..solver.laws.user import UserLaw
from ..solver.model.model import Model
from ..solver.simulation import start_warnings
from ..solver.stepper import Stepper
from .archive import archive
from .description import Experiment, description, terminals
from .errors import FMUError
from .image import image_of, token_of
from .library import C_SOURCES, FMI_PLATFORMS, Parts, StepTimes, compiler_of, linked, step_times
from .naming import identifier
from .parameters import kept_by_gains
from .variables import Variable, VariableKind, variables

FMI_VERSIONS = (2, 3)
CPU_NAMES = ("x86-64-v3", "x86-64-v2", "native")
STEP_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class ExportedModel:
    """What was written.

    experiment: the names and steps that importers are told; sizes: of the libraries by their
    platforms [bytes]; notes: what importers or users should know; parts: of the libraries.
    """

    path: Path
    version: int
    experiment: Experiment
    variables: tuple[Variable, ...]
    sizes: dict[str, int]
    notes: tuple[str, ...]
    parts: tuple[Parts, ...]

    @property
    def inputs(self) -> tuple[Variable, ...]:
        return tuple(one for one in self.variables if one.kind is VariableKind.INPUT)

    def times(self, n: int = 2000) -> StepTimes | None:
        """How long n steps take on this machine; None where it is none of the platforms."""
        # Code for another platform cannot run here.
        for parts in self.parts:
            if parts.name == own_platform():
                return step_times(parts, self.experiment.token, n)
        return None


def export_fmu(
    model: Model,
    path: str | os.PathLike[str],
    *,
    outputs: Sequence[str] = (),
    parameters: Sequence[str] = (),
    communication: float | None = None,
    platforms: Sequence[str] = (),
    version: int = 3,
    cpu: str = "x86-64-v3",
) -> ExportedModel:
    """Write a model as an FMU for co-simulation, which steps it without Python.

    With the processor of this machine its outputs are, to the bit, those of `solver.Simulator`.

    Parameters
    ----------
    model : Model
        Its signals `Input` are the inputs.
    path : path
        A new file, or one to be replaced.
    outputs : sequence of str
        As "joints/pivot/angle"; stars stand for anything. By default the quantities of `[output]`,
        or else all of joints, motors, sensors and energies.
    parameters : sequence of str
        What importers may change between steps, as "motors/servo/stiffness": see
        docs/how-to/fmu.md.
    communication : float, optional [s]
        The step of importers. The internal step becomes a whole fraction of it, no longer than that
        of the model; without it, importers take multiples of the step of the model.
    platforms : sequence of str
        Of "x86_64-linux", "aarch64-linux", "x86_64-windows" and "aarch64-darwin"; by default that
        of this machine.
    version : {3, 2}
        Of FMI.
    cpu : {"x86-64-v3", "x86-64-v2", "native"}
        The least processor of x86-64 platforms; "native" is that of this machine.

    Returns
    -------
    ExportedModel

    Raises
    ------
    FMUError
        For what an FMU cannot do, and where a compiler is missing.
    ModelError
        For a model that cannot start.
    """
    _check_options(platforms, version, cpu)
    target = Path(path)
    if model.path:
        require_no_input(target, [Path(model.path)], "the model file", "FMU")
    # Before anything is compiled or linked: what cannot be exported is told at once.
    with about(model.path):
        stepper, notes = _stepper(model, communication)
        chosen = variables(stepper, outputs, parameters)
        image = image_of(stepper, chosen)
    notes += tuple(kept_by_gains(stepper.lowered, parameters))
    name = Path(model.path).stem if model.path else target.stem
    h = stepper.lowered.longest_step
    experiment = Experiment(
        name=name,
        identifier=identifier(name),
        token=token_of(image),
        step=h,
        communication=communication or h,
        stop=stepper.lowered.n_steps * stepper.lowered.h,
    )
    parts = _parts(tuple(platforms) or (own_platform(),), cpu, experiment, image)
    libraries = {one.name: linked(one) for one in parts}
    # Importers look for these paths, which the standard fixes.
    contents = {"modelDescription.xml": description(version, experiment, chosen)}
    if version == 3:
        contents["terminalsAndIcons/terminalsAndIcons.xml"] = terminals(chosen)
    contents["documentation/licenses/license.txt"] = C_SOURCES.joinpath("licenses.txt").read_bytes()
    for one, library in libraries.items():
        platform = FMI_PLATFORMS[one]
        folder = one if version == 3 else platform.name_2
        contents[f"binaries/{folder}/{experiment.identifier}{platform.suffix}"] = library
    with renamed_when_whole(target, failure=FMUError) as temporary:
        temporary.write_bytes(archive(contents))
    sizes = {one: len(library) for one, library in libraries.items()}
    return ExportedModel(target, version, experiment, chosen, sizes, notes, parts)


def _check_options(platforms: Sequence[str], version: int, cpu: str) -> None:
    if version not in FMI_VERSIONS:
        raise FMUError(f"fmi: expected 3 or 2, got {version}")
    if cpu not in CPU_NAMES:
        raise FMUError(f"cpu: expected {' or '.join(CPU_NAMES)}, got {cpu!r}")
    for name in platforms or (own_platform(),):
        if name not in FMI_PLATFORMS:
            raise FMUError(f"platform: expected of {', '.join(FMI_PLATFORMS)}, got {name!r}")
        if version == 2 and not FMI_PLATFORMS[name].name_2:
            raise FMUError(f"platform {name}: FMI 2 has no folder for it: expected FMI 3")
        if cpu == "native" and name != own_platform():
            raise FMUError(f"cpu native: expected the platform {own_platform()}, got {name!r}")


def _stepper(model: Model, communication: float | None) -> tuple[Stepper, tuple[str, ...]]:
    """A model before its first step, with steps that fit the communication step, and notes."""
    if model.fmus:
        raise FMUError(f"{model.fmus[0].owner}: an FMU cannot run another one")
    stepper = Stepper(model, ())
    notes = list(start_warnings(stepper.initial))
    if communication is not None:
        if not communication > 0.0 or not np.isfinite(communication):
            raise FMUError(f"communication: expected a time above 0 s, got {communication:g}")
        # Rounded up: the internal step must not be longer than that of the model.
        own, ratio = stepper.lowered.longest_step, stepper.lowered.ratio
        n = max(1, int(np.ceil(communication / own - STEP_ROUNDING)))
        step = communication / n
        if step != own:
            notes.append(
                f"the internal step is {step:.6g} s, 1/{n} of the communication step, not the "
                f"{own:.6g} s of the model"
            )
            contact_step = step / ratio if ratio > 1 else None
            model = model.with_settings(step=step, contact_step=contact_step)
            stepper = Stepper(model, ())
    kernels = stepper.lowered.system.elastic.kernels
    # The C code has no FFT; the sum is the same to rounding.
    if kernels.by_fft.any():
        notes.append('past loads are summed directly (history = "direct"), not by FFT')
        stepper = Stepper(model.with_settings(history="direct"), ())
    if (stepper.lowered.system.couplings.laws.number == UserLaw.number).any():
        raise FMUError(
            "laws: a UserLaw is a function of Python, which an FMU cannot call: expected a law of "
            "Duhamel, as a table"
        )
    return stepper, tuple(notes)


def _parts(
    platforms: Sequence[str], cpu: str, experiment: Experiment, image: bytes
) -> tuple[Parts, ...]:
    """What is linked, for each platform."""
    for one in platforms:
        compiler_of(one)  # a missing one is told before the time step is compiled
    # All at once: functions are typed once for all targets.
    targets = [_target(one, cpu) for one in platforms]
    codes, level = object_files(targets), 3 if cpu == "x86-64-v3" else 0
    return tuple(
        Parts(one, experiment.identifier, codes[target], image, level)
        for one, target in zip(platforms, targets, strict=True)
    )


def _target(platform: str, cpu: str) -> str:
    """The name of the target that the time step is compiled for."""
    if cpu == "native":
        return cpu
    return f"{platform}-v2" if cpu == "x86-64-v2" and platform.startswith("x86_64") else platform
