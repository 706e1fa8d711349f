"""`duhamel animate`."""

from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from ..arguments import (
    FromTime,
    ResultsFile,
    Title,
    ToTime,
    beside,
    output_option,
    size_of,
)
from ..failures import errors_in_one_line, one_line, tell_warning
from ..progress import shown_parts

if TYPE_CHECKING:
    from ...view.space import Film

FilmFile = Annotated[
    Path | None,
    output_option("FILE", "A film, .mp4 or .gif; a picture, .png; pictures, frame-%04d.png."),
]
FieldName = Annotated[
    str | None,
    typer.Option(
        "--field",
        metavar="displacement|velocity|von_mises|pressure|none",
        help="What colors show: stresses where they are known, else displacements.",
    ),
]
Limit = Annotated[
    float | None,
    typer.Option(metavar="VALUE", help="Where colors end; the largest value unless given."),
]
Magnify = Annotated[
    float | None, typer.Option(metavar="FACTOR", help="Of deformations; chosen unless given.")
]
AtTime = Annotated[
    str | None,
    typer.Option(
        metavar="SECONDS|worst",
        help="One picture, of a time or of the largest value of the field.",
    ),
]
FrameCount = Annotated[int | None, typer.Option(min=1, max=100_000, help="Frames of the film.")]
FramesPerSecond = Annotated[
    float | None,
    typer.Option(min=0.1, max=240.0, help="Frames in a second of playing: 25 unless given."),
]
Seconds = Annotated[
    float | None,
    typer.Option(min=0.01, max=3600.0, help="Length of the film: 8 unless given."),
]
PictureSize = Annotated[
    str | None,
    typer.Option(metavar="WIDTHxHEIGHT", help="1280x720 unless given, 640x360 of a GIF."),
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
# As view.space.timing has it, which is not imported for a page of help.
FRAMES_PER_SECOND = 25.0


def animate(
    results_file: ResultsFile,
    output: FilmFile = None,
    field: FieldName = None,
    limit: Limit = None,
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
    title: Title = None,
) -> None:
    """Make a film of a run, or a picture of one time: RESULTS.mp4 beside the file, unless given.

    Bodies move as they did; deformation is magnified where it would not be seen, and the film says
    by how much. Colors have one scale for all frames. With --at: RESULTS-frame.png.
    """
    _require_sense(at, start, end, frames, fps, seconds)
    began = perf_counter()
    from ... import files, results
    from ... import view as pictures

    pixels = size_of(size, int, 1, 10_000, "pixels, as 1280x720")
    default = beside(results_file, ".mp4") if at is None else beside(results_file, ".png", "frame")
    target = output or default
    with errors_in_one_line(files, results, pictures):
        run = results.Results.read(results_file)
        files.require_no_input(target, [results_file], "the results file", "film")
        with shown_parts("frames") as on_frame:
            film = pictures.animate(
                run,
                target,
                field=field,
                limit=limit,
                magnify=magnify,
                start=start,
                end=end,
                at=at,
                frames=frames,
                fps=FRAMES_PER_SECOND if fps is None else fps,
                seconds=seconds,
                size=pixels,
                view=view,
                marks=marks,
                title=results_file.stem if title is None else title,
                on_frame=on_frame,
                on_warning=lambda warning: tell_warning(f"{results_file}: {warning}"),
            )
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
    # The worst time is looked for in a window; another one says all itself.
    if at != "worst" and (start is not None or end is not None):
        raise typer.BadParameter(f"--from and --to go with --at worst, found --at {at}")


def told(film: "Film") -> str:
    """What a film shows."""
    words = (
        ["1 frame"] if film.frames == 1 else [f"{film.frames} frames", f"{film.seconds:.3g} s long"]
    )
    if film.magnification != 1.0:
        words.append(f"deformation x {film.magnification:g}")
    if film.field:
        which = "this time" if film.frames == 1 else "all frames"
        end = "a given limit" if film.limit != film.largest else f"the largest of {which}"
        words.append(f"colors up to {film.scale_end}, {end}")
    return ", ".join(words)
