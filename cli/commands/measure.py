"""`duhamel measure`."""

from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from ..arguments import TOML_SUFFIX, beside, file_argument, output_option
from ..completion import files as files_of
from ..failures import errors_in_one_line, one_line

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rich.table import Table

    from ...preprocess import Body, MeasuredBody
    from ...preprocess.hammer.simulation import HammerErrors
    from ...preprocess.progress import Stages
    from ..hammer import PlanKeys

BodyOfMesh = Annotated[
    Path, file_argument("BODY.toml", "A mesh of solids with damping.", TOML_SUFFIX)
]
Plans = Annotated[
    list[Path] | None,
    typer.Option(
        "--plan",
        metavar="TESTED.toml",
        help="Where to hit and measure, by the body file of the test; a plan is made unless given. "
        "With --predict several.",
        autocompletion=files_of(TOML_SUFFIX),
    ),
]
TestOutput = Annotated[
    Path | None,
    output_option(
        "PATH", "The folder of a plan that is made, BODY-test; of a given one, the responses."
    ),
]
Predicted = Annotated[
    int | None,
    typer.Option(
        "--predict",
        metavar="N",
        min=1,
        help="Write nothing: identify the part from N tests, and print its errors.",
    ),
]
NoiseRatio = Annotated[
    float, typer.Option(metavar="RATIO", min=0.0, help="Noise of each response, relative.")
]
AngleError = Annotated[
    float, typer.Option(metavar="DEGREES", min=0.0, help="Of the directions of sensors and hits.")
]
PlaceError = Annotated[
    float,
    typer.Option(
        metavar="METERS", min=0.0, help="Distance of sensors and hits from their places, rms."
    ),
]
GainError = Annotated[
    float, typer.Option(metavar="RATIO", min=0.0, help="Of the gains of sensors, relative.")
]
Cords = Annotated[
    float,
    typer.Option(
        metavar="HERTZ", min=0.0, help="How fast the part moves to and fro on its cords; 0: free."
    ),
]
TestSeed = Annotated[int, typer.Option(min=0, help="Each number draws other errors: another test.")]
LineCount = Annotated[
    int, typer.Option(min=100, max=100_000, help="Frequencies from zero to the end of the band.")
]
BandOfTest = Annotated[
    tuple[float, float] | None,
    typer.Option(
        "--band", metavar="LOW HIGH", help="[Hz] of a plan that is made; a given one has its own."
    ),
]
WindowRate = Annotated[
    float, typer.Option(metavar="RATE", min=0.0, help="Exponential, of a plan that is made [1/s].")
]
SensorMass = Annotated[
    float, typer.Option(metavar="KG", min=0.0, help="Of each sensor of a plan that is made.")
]
ResponseFormat = Annotated[
    str, typer.Option("--format", metavar="FORMAT", help="Of a plan that is made: uff or npz.")
]


def measure(
    body_file: BodyOfMesh,
    plan: Plans = None,
    output: TestOutput = None,
    predict: Predicted = None,
    noise: NoiseRatio = 0.02,
    angle: AngleError = 2.0,
    place: PlaceError = 1e-3,
    gain: GainError = 0.01,
    cords: Cords = 0.0,
    seed: TestSeed = 1,
    lines: LineCount = 3200,
    band: BandOfTest = None,
    window: WindowRate = 0.0,
    sensor_mass: SensorMass = 0.0,
    suffix: ResponseFormat = "uff",
) -> None:
    """Simulate a hammer test of a mesh: what it measures, or how good a part it makes.

    Errors are standard deviations; --noise 0 --angle 0 --place 0 --gain 0 is a test without any.
    """
    if plan and (band or window or sensor_mass):
        raise typer.BadParameter("--band, --window and --sensor-mass are those of the --plan")
    if plan and len(plan) > 1 and predict is None:
        raise typer.BadParameter("expected several plans only with --predict")
    if predict is not None and output is not None:
        raise typer.BadParameter("--predict writes nothing, found --output")
    if band is not None and not 0.0 < band[0] < band[1] < inf:
        raise typer.BadParameter(
            f"--band: expected two frequencies [Hz], the lower one first, found {band[0]:g} "
            f"{band[1]:g}"
        )
    if suffix not in ("uff", "npz"):
        raise typer.BadParameter(f"--format: expected uff or npz, found {suffix}")
    start = perf_counter()
    from ... import files, preprocess, superelement
    from ...preprocess.hammer.simulation import HammerErrors
    from ...preprocess.progress import shown_stages
    from ..hammer import PlanKeys, body_of_mesh, plan_of, require_untaken, told_apart

    # A quarter of the noise is there without a response.
    errors = HammerErrors(noise, 0.25 * noise, angle, place, gain, cords, seed)
    keys = PlanKeys(band, window, sensor_mass, f".{suffix}")
    # Before the work, not after it.
    with errors_in_one_line(files, preprocess):
        body = body_of_mesh(body_file)
        plans = {named: plan_of(path) for named, path in told_apart(plan or []).items()}
        first = next(iter(plans.values()), None)
        target = output or (first.measured.frf if first else beside(body_file, "", "test"))
        if predict is None:
            require_untaken(target, is_folder=first is None)
    with (
        errors_in_one_line(files, preprocess, superelement, about=body_file),
        shown_stages(True, _warn) as stages,
    ):
        if predict is not None:
            found = _predicted(body, plans, keys, errors, predict, lines, stages)
        elif first is not None:
            _by_plan(body, first, target, errors, lines, stages)
        else:
            target = _by_made_plan(body, target, keys, errors, lines, stages)
    if predict is None:
        typer.echo(one_line(f"{target}: {perf_counter() - start:.1f} s"))
        return
    from rich.console import Console

    Console().print(found)


def _warn(text: str) -> None:
    typer.echo(one_line(f"warning: {text}"), err=True)


def _by_plan(
    body: "Body",
    plan: "MeasuredBody",
    target: Path,
    errors: "HammerErrors",
    lines: int,
    stages: "Stages",
) -> None:
    """The responses of a plan that is given."""
    from ...preprocess.hammer.bench import bench_of
    from ..hammer import measured_to_files

    measured_to_files(bench_of(body, plan, stages), target, errors, lines, stages)


def _by_made_plan(
    body: "Body",
    folder: Path,
    keys: "PlanKeys",
    errors: "HammerErrors",
    lines: int,
    stages: "Stages",
) -> Path:
    """A folder with a plan and its responses, whose path is returned."""
    from ..hammer import folder_when_whole, measured_to_files

    with folder_when_whole(folder) as made:
        bench = keys.bench(body, made, stages)
        responses = bench.plan.measured.frf
        measured_to_files(bench, responses, errors, lines, stages)
    return folder / responses.name


def _predicted(
    body: "Body",
    plans: "Mapping[str, MeasuredBody]",
    keys: "PlanKeys",
    errors: "HammerErrors",
    tests: int,
    lines: int,
    stages: "Stages",
) -> "Table":
    """What tests by one or more plans would make of the part."""
    from ...preprocess.hammer.bench import bench_of
    from ..hammer import errors_of_plan, prediction_table

    found = [
        errors_of_plan(name, bench_of(body, plan, stages), errors, tests, lines, stages)
        for name, plan in plans.items()
    ]
    if not plans:
        with TemporaryDirectory() as folder:
            bench = keys.bench(body, Path(folder), stages)
            found.append(errors_of_plan("as made", bench, errors, tests, lines, stages))
    for one in found:
        for refused in one.refused:
            stages.warn(f"{one.name}: {refused}")
    return prediction_table(body.name, found)
