"""`duhamel animate`."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from ..arguments import ResultsFile
from ..failures import errors_in_one_line, one_line

if TYPE_CHECKING:
    from ...view.space import Film

FilmFile = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="FILE",
        help="A film, .mp4 or .gif; a picture, .png; pictures, frame-%04d.png.",
        show_default=False,
    ),
]
FieldName = Annotated[
    str | None,
    typer.Option(
        "--field",
        metavar="displacement|velocity|von_mises|none",
        help="What colors show: stresses where they are known, else displacements.",
        show_default=False,
    ),
]
Magnify = Annotated[
    float | None,
    typer.Option(
        metavar="FACTOR", help="Of deformations; chosen unless given.", show_default=False
    ),
]
FromTime = Annotated[
    float | None,
    typer.Option("--from", metavar="SECONDS", help="From this time.", show_default=False),
]
ToTime = Annotated[
    float | None,
    typer.Option("--to", "--until", metavar="SECONDS", help="Up to this time.", show_default=False),
]
AtTime = Annotated[
    str | None,
    typer.Option(
        metavar="SECONDS|worst",
        help="One picture, of a time or of the largest value of the field.",
        show_default=False,
    ),
]
FrameCount = Annotated[
    int | None, typer.Option(min=1, max=100_000, help="Frames of the film.", show_default=False)
]
FramesPerSecond = Annotated[
    float | None,
    typer.Option(
        min=0.1,
        max=240.0,
        help="Frames in a second of playing: 25 unless given.",
        show_default=False,
    ),
]
Seconds = Annotated[
    float | None,
    typer.Option(
        min=0.01, max=3600.0, help="Length of the film: 8 unless given.", show_default=False
    ),
]
PictureSize = Annotated[
    str | None,
    typer.Option(
        metavar="WIDTHxHEIGHT", help="1280x720 unless given, 640x360 of a GIF.", show_default=False
    ),
]
View = Annotated[
    str,
    typer.Option(
        metavar="iso|xy|xz|yz|X,Y,Z",
        help="Where the eye is; chosen by the motion and gravity unless given.",
        show_default=False,
    ),
]
Marks = Annotated[
    bool, typer.Option("--marks/--no-marks", help="Joints, springs, contacts, forces.")
]
FPS = 25.0
"""frames per second of playing"""
FilmTitle = Annotated[
    str | None, typer.Option(metavar="TEXT", help="The name of the file, unless given.")
]


def animate(
    results_file: ResultsFile,
    output: FilmFile = None,
    field: FieldName = None,
    magnify: Magnify = None,
    start: FromTime = None,
    end: ToTime = None,
    at: AtTime = None,
    frames: FrameCount = None,
    fps: FramesPerSecond = None,
    seconds: Seconds = None,
    size: PictureSize = None,
    view: View = "",
    marks: Marks = True,
    title: FilmTitle = None,
) -> None:
    """Make a film of a run, or a picture of one time: RESULTS.mp4 beside the file, unless given.

    Bodies move as they did; deformation is magnified where it would not be seen, and the film says
    by how much. Colors have one scale for all frames. With --at: RESULTS.png.
    """
    _require_sense(at, start, end, frames, fps, seconds)
    began = perf_counter()
    from ... import results
    from ... import view as pictures
    from ...files.outputs import clash

    target = output or results_file.with_suffix(".mp4" if at is None else ".png")
    with errors_in_one_line(results, pictures):
        run = results.Results.read(results_file)
        if found := clash([target], {results_file: "the results file"}):
            raise pictures.PictureError(f"{found}, which the film would replace")
        with shown("frames") as on_frame:
            film = pictures.animate(
                run,
                target,
                field=field,
                magnify=magnify,
                start=start,
                end=end,
                at=at,
                frames=frames,
                fps=FPS if fps is None else fps,
                seconds=seconds,
                size=size_of(size),
                view=view,
                marks=marks,
                title=results_file.stem if title is None else title,
                on_frame=on_frame,
            )
    for warning in film.warnings:
        typer.echo(one_line(f"warning: {results_file}: {warning}"), err=True)
    typer.echo(one_line(f"{target}: {told(film)}, {perf_counter() - began:.1f} s"))


def _require_sense(
    at: str | None,
    start: float | None,
    end: float | None,
    frames: int | None,
    fps: float | None,
    seconds: float | None,
) -> None:
    """Refuse what would be passed over."""
    if at is None:
        return
    if frames is not None or fps is not None or seconds is not None:
        raise typer.BadParameter("--frames, --fps and --seconds are of films, found --at")
    if at != "worst" and (start is not None or end is not None):
        raise typer.BadParameter(f"--from and --to go with --at worst, found --at {at}")


def size_of(text: str | None) -> tuple[int, int] | None:
    """Width and height of "1280x720"."""
    if text is None:
        return None
    width, _, height = text.lower().partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise typer.BadParameter(f"--size: expected WIDTHxHEIGHT, as 1280x720, found {text!r}")
    return int(width), int(height)


def told(film: "Film") -> str:
    """What a film shows."""
    words = (
        ["1 frame"] if film.frames == 1 else [f"{film.frames} frames", f"{film.seconds:.3g} s long"]
    )
    if film.magnification != 1.0:
        words.append(f"deformation x {film.magnification:g}")
    if film.field:
        which = "this time" if film.frames == 1 else "all frames"
        words.append(f"colors up to {film.scale_end}, the largest of {which}")
    return ", ".join(words)


@contextmanager
def shown(unit: str) -> Iterator[Callable[[int, int], object]]:
    """Progress with the time that remains, told the parts that are done and all of them."""
    from ...files.progress import Progress, Work

    with Progress(Work(unit=unit)) as work:

        def tell(done: int, total: int) -> None:
            work.total = total
            work.advance(done - work.done)

        yield tell
