"""What setuptools puts into the wheel."""

import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_every_folder_with_modules_is_a_package_of_the_wheel():
    """Setuptools takes the packages that are listed, and no others."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    folders = {
        ".".join(("duhamel", *path.parent.relative_to(ROOT).parts))
        for package in settings["package-dir"].values()
        for path in (ROOT / package).rglob("*.py")
    }
    assert sorted(settings["packages"]) == sorted(folders)


def test_every_package_of_the_makefile_is_in_the_wheel():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    line = next(
        line for line in (ROOT / "Makefile").read_text().splitlines() if line.startswith("PACKAGES")
    )
    assert set(line.split(":=")[1].split()) == set(settings["package-dir"].values())
