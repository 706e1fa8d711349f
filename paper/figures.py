"""The figures of the paper, by the examples that check them.

    python paper/figures.py

writes rotating-beam.png and colliding-rods.png beside this file. Each example stops where a number
is wrong. With Exudyn installed, the first figure has the geometrically exact solution too.
"""

import sys
import tempfile
from pathlib import Path

from duhamel import view

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "examples"))

import colliding_rods
import rotating_beam


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        motions = rotating_beam.main(Path(folder))
        rods = colliding_rods.main(Path(folder))
    case = rotating_beam.CASES[1]
    kinds = (motions.get(f"{case.name}-{kind}") for kind in ("consistent", "paper", "exudyn"))
    with view.style():
        view.save(rotating_beam.comparison(case, *kinds), HERE / "rotating-beam.png")
        view.save(colliding_rods.picture(rods), HERE / "colliding-rods.png")


if __name__ == "__main__":
    main()
