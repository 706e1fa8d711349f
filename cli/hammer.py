"""Simulated hammer tests: their files, and tables of what they would tell of a part."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from rich.table import Table

from .. import preprocess
from ..preprocess import Body, BodyError, MeasuredBody, MeasurementError
from ..preprocess.hammer.bench import HammerBench, planned_bench
from ..preprocess.hammer.plan_files import PlannedFiles
from ..preprocess.hammer.prediction import PredictedErrors, predicted_errors
from ..preprocess.hammer.simulation import HammerErrors
from ..preprocess.measured.response_files import require_writable_format, write_responses
from ..preprocess.progress import Stages
from .tables import table

RESPONSE_FILE = "responses.npz"
PREDICTION_HEADINGS = "plan", "channels", "hits", "modes", "frequency", "damping", "responses"


@dataclass(frozen=True)
class PlanKeys:
    """What is asked of a plan that is made; suffix: of its responses."""

    band: tuple[float, float] | None
    window: float
    sensor_mass: float
    suffix: str

    def bench(self, body: Body, folder: Path, stages: Stages) -> HammerBench:
        files = PlannedFiles(folder, f"{body.name}{self.suffix}", self.window, self.sensor_mass)
        return planned_bench(body, files, stages, self.band or (None, None))


@dataclass(frozen=True, eq=False)
class PlanErrors:
    """The errors of the parts that tests by a plan make, or why there are none."""

    name: str
    bench: HammerBench
    errors: tuple[PredictedErrors, ...]
    refused: tuple[str, ...]


def body_of_mesh(path: Path) -> Body:
    """The body of a file; `BodyError` for one that is a test itself."""
    body = preprocess.read_body(path)
    if not isinstance(body, Body):
        raise BodyError(f"{path}: expected a mesh, which is to be tested, found a test")
    # Surfaces alone have no points that joints take, which a test is to tell of.
    if not body.interfaces:
        raise BodyError(f"{path}: expected [interfaces.NAME], which are tested, found none")
    return body


def plan_of(path: Path) -> MeasuredBody:
    """The plan of a file; `BodyError` for one of a mesh."""
    plan = preprocess.read_body(path)
    if isinstance(plan, MeasuredBody):
        if plan.measured.quantity not in (None, "accelerance"):
            raise BodyError(
                f"{path}: measured.quantity: expected accelerance, which is simulated, found "
                f"{plan.measured.quantity}"
            )
        return plan
    raise BodyError(f"{path}: expected a plan, a body file with [measured] frf, found a mesh")


def told_apart(paths: Sequence[Path]) -> dict[str, Path]:
    """Plans by their names in tables: those of the files, or their paths where these are alike."""
    stems = [path.stem for path in paths]
    return {path.stem if stems.count(path.stem) == 1 else str(path): path for path in paths}


def measured_to_files(
    bench: HammerBench, target: Path, errors: HammerErrors, lines: int, stages: Stages
) -> None:
    """Write the responses of a test."""
    f = bench.lines(lines)
    for doubt in bench.doubts(f):
        stages.warn(doubt)
    with stages.stage("responses"):
        write_responses(target, bench.measured(errors, f), bench.channels, bench.hits)


def require_untaken(path: Path, is_folder: bool) -> None:
    """`MeasurementError` for a file or folder that is there: it may be a real measurement."""
    if not is_folder:
        require_writable_format(path)
    if path.exists():
        raise MeasurementError(
            f"{path} exists, and may be what was measured: name another with --output"
        )


@contextmanager
def folder_when_whole(target: Path) -> Iterator[Path]:
    """A folder that gets its name when all is in it: half a test looks like a whole one."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(dir=target.parent, prefix=f".{target.name}.") as scratch:
        made = Path(scratch) / target.name
        made.mkdir()
        yield made
        made.rename(target)


def errors_of_plan(
    name: str, bench: HammerBench, errors: HammerErrors, tests: int, lines: int, stages: Stages
) -> PlanErrors:
    """The errors of the parts that a number of tests make, each with a seed of its own."""
    f, found, refused = bench.lines(lines), list[PredictedErrors](), list[str]()
    told = list[str]()
    for doubt in bench.doubts(f):
        stages.warn(doubt)
    with TemporaryDirectory() as folder:
        responses = Path(folder) / RESPONSE_FILE
        measured = bench.plan.measured.model_copy(update={"frf": responses})
        body = bench.plan.model_copy(update={"measured": measured})
        for seed in range(errors.seed, errors.seed + tests):
            with stages.stage(f"{name}: test {seed - errors.seed + 1} of {tests}"):
                data = bench.measured(replace(errors, seed=seed), f)
                write_responses(responses, data, bench.channels, bench.hits)
                # By the way of any test: what would be refused on the bench is refused here.
                try:
                    element = preprocess.build(body, on_warning=told.append)
                except MeasurementError as error:
                    refused.append(str(error).replace(f"{responses}: ", ""))
                    continue
            found.append(predicted_errors(bench.part, element, measured.band[0]))
    for doubt in dict.fromkeys(told):
        stages.warn(f"{name}: {doubt.replace(f'{responses}: ', '')}")
    return PlanErrors(name, bench, tuple(found), tuple(refused))


def prediction_table(title: str, plans: Sequence[PlanErrors]) -> Table:
    """A row for each plan: the largest errors of its tests."""
    title = f"{title}: largest errors, of responses in each third of the band"
    return table(title, PREDICTION_HEADINGS, map(_row, plans), "tnnnnnn")


def _row(plan: PlanErrors) -> list[str]:
    test = [str(len(plan.bench.channels.names)), str(len(plan.bench.hits.labels))]
    if not plan.errors:
        return [plan.name, *test, "refused", "", "", ""]
    fewest = min(plan.errors, key=lambda one: one.found)
    thirds = np.max([one.responses for one in plan.errors], axis=0)
    return [
        plan.name,
        *test,
        f"{fewest.found} of {fewest.modes}",
        _percent(max(one.frequency for one in plan.errors)),
        _percent(max(one.damping for one in plan.errors)),
        ", ".join(f"{100.0 * value:.2g}" for value in thirds.tolist()) + " %",
    ]


def _percent(value: float) -> str:
    if np.isnan(value):
        return "none"
    return f"{100.0 * value:.2g} %"
