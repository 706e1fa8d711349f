"""Films of the examples for the gallery: docs/images/films/EXAMPLE.gif.

python tools/make_films.py [EXAMPLE]...

Models are run in a scratch copy, with the superelements that they name, and told with the seconds
of `duhamel run`. Without names: all models that are examples.
"""

import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

ROOT = Path(__file__).parents[1]
FILMS = ROOT / "docs" / "images" / "films"
FILM = ("--size", "480x300", "--frames", "40", "--fps", "12")
OPTIONS = {
    "flat_rods": ("--magnify", "100"),
    "oil_whip": ("--from", "8.6", "--to", "9.0"),
}
"""of films that show too much otherwise: faces would come apart, a whirl would be a blur"""

WITHOUT_FILM = {"campbell"}
"""a round rotor that turns looks as if it stood still"""


def main(names: list[str]) -> None:
    FILMS.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as scratch:
        for folder in ("examples", "meshes"):
            shutil.copytree(ROOT / folder, Path(scratch) / folder)
        for model in models(Path(scratch) / "examples"):
            if not names or model.stem in names:
                make_film(model)


def models(folder: Path) -> Iterator[Path]:
    """The model files among the examples: those with bodies, in which something is seen to move."""
    for path in sorted(folder.glob("*.toml")):
        if path.stem not in WITHOUT_FILM and "bodies" in tomllib.loads(path.read_text()):
            yield path


def make_film(model: Path) -> None:
    for body in tomllib.loads(model.read_text())["bodies"].values():
        if "superelement" in body:
            element = (model.parent / body["superelement"]).resolve()
            # Of a part that is tested the script of the example makes the test.
            if not element.exists() and not element.with_suffix(".toml").exists():
                subprocess.run([sys.executable, model.with_suffix(".py")], check=True)
            if not element.exists():
                duhamel("preprocess", element.with_suffix(".toml"))
    results = model.with_name("results.h5")
    start = perf_counter()
    duhamel("run", model, "-o", results)
    seconds = perf_counter() - start
    film = FILMS / f"{model.stem}.gif"
    duhamel(
        "animate",
        results,
        "-o",
        film,
        "--title",
        model.stem.replace("_", " "),
        *FILM,
        *OPTIONS.get(model.stem, ()),
    )
    print(f"{model.stem}: run {seconds:.1f} s, film {film.stat().st_size / 1e3:.0f} kB", flush=True)


def duhamel(*arguments: object) -> None:
    command = [sys.executable, "-m", "duhamel", *map(str, arguments)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


if __name__ == "__main__":
    main(sys.argv[1:])
