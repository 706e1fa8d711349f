"""From the file of a robot to a model file."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from ..files import renamed_when_whole, require_no_input
from ..files.outputs import in_words
from ..solver import ModelError, read_model
from .bodies import ModelBody
from .conversion import Conversion, convert
from .document import document_of
from .errors import RobotError
from .options import ImportOptions
from .reading import read_robot
from .shapes import Shaper


@dataclass(frozen=True)
class ImportedRobot:
    """What an import has written, see `import_robot` for an example.

    Parameters
    ----------
    path : Path
        Of the model file.
    bodies, joints, stops, motors : int
        How many the model has.
    mass : float [kg]
        Of all bodies.
    remarks : tuple of str
        What the model does not take of the robot, or takes otherwise.
    """

    path: Path
    bodies: int
    joints: int
    stops: int
    motors: int
    mass: float
    remarks: tuple[str, ...]


def import_robot(
    source: Path | str, target: Path | str, options: ImportOptions | None = None
) -> ImportedRobot:
    """Write the model file of a robot in URDF or MJCF; it appears whole or not at all.

    Parameters
    ----------
    source : path
        The robot.
    target : path
        The model file, in TOML.
    options : ImportOptions, optional

    Returns
    -------
    ImportedRobot

    Raises
    ------
    RobotError
        Names the file, and the link or joint.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> urdf = '<robot name="stone"><link name="base"/></robot>'
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "stone.urdf")
    ...     _ = path.write_text(urdf, encoding="utf-8")
    ...     try:
    ...         import_robot(path, path.with_suffix(".toml"))
    ...     except RobotError as error:
    ...         print(str(error).partition("stone.urdf: ")[2])
    expected a joint that moves, or --base free: nothing of the robot would be a body
    """
    source, target = Path(source), Path(target)
    options = options or ImportOptions()
    require_no_input(target, [source], "the robot", "model")
    robot = read_robot(source)
    # Everything is computed before anything is written: an error leaves no file.
    shaper = Shaper(robot, target, options.packages)
    conversion = convert(robot, options, target.parent, shaper.give_shape)
    if len(conversion.bodies) == 1:
        raise RobotError(
            f"{source}: expected a joint that moves, or --base free: nothing of the robot would be "
            "a body"
        )
    text = document_of(_head(robot.name, source, conversion), conversion.sections)
    with _removed_unless_whole(shaper), renamed_when_whole(target, failure=RobotError) as temporary:
        # The model names the shapes, and reading it back needs them.
        shaper.write()
        temporary.write_text(text, encoding="utf-8")
        _require_readable(temporary, target)
    return _counted(target, conversion)


@contextmanager
def _removed_unless_whole(shaper: Shaper) -> Iterator[None]:
    """Remove shapes whose model is not written, unless they were there before."""
    new = [path for path in shaper.facets if not path.exists()]
    new_folder = not shaper.folder.exists()
    try:
        yield
    except BaseException as error:
        for path in new:
            path.unlink(missing_ok=True)
        if new_folder and shaper.folder.is_dir() and not any(shaper.folder.iterdir()):
            shaper.folder.rmdir()
        if isinstance(error, OSError):
            raise RobotError(f"{shaper.folder}: cannot be written: {in_words(error)}") from error
        raise


def _head(name: str, source: Path, conversion: Conversion) -> list[str]:
    """Where the model is from, and what it has not."""
    lines = [f"Robot {name!r}, imported from {source.name}."]
    if conversion.remarks:
        lines += ["", "Not taken from the robot, or taken otherwise:"]
        lines += [f"- {remark}" for remark in conversion.remarks]
    return lines


def _require_readable(temporary: Path, target: Path) -> None:
    """`RobotError` for a model that could not be run: nothing is written then."""
    try:
        read_model(temporary)
    except ModelError as error:
        said = str(error).replace(str(temporary), str(target))
        raise RobotError(f"{said}; the model is not written") from error


def _counted(target: Path, conversion: Conversion) -> ImportedRobot:
    heads = [section.head for section in conversion.sections]
    bodies: list[ModelBody] = list(conversion.bodies.values())
    return ImportedRobot(
        target,
        len(bodies) - 1,
        len(conversion.joints),
        heads.count("[[stops]]"),
        heads.count("[[motors]]"),
        sum(body.mass for body in bodies),
        tuple(conversion.remarks),
    )
