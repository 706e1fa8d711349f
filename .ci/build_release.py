"""Wheel and sdist of the commit at hand, built twice from nothing: both must have the same bytes.

    python .ci/build_release.py build/release [v1.2.3]

Each build has a copy of the commit in a folder of its own and compiles the time step anew. Times in
archives are that of the commit (SOURCE_DATE_EPOCH). The changelog must have a section of the
version, with its date where a tag is given, which must be that of the version. With changes that
are not committed it fails.
"""

import gzip
import hashlib
import io
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def main(target: str, tag: str = "") -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    if tag and tag != f"v{version}":
        sys.exit(f"the tag is {tag}, and the version of pyproject.toml {version}")
    notes = (ROOT / "CHANGELOG.md").read_text()
    found = re.search(
        rf"^## \[{re.escape(version)}\](?: - (\d{{4}}-\d\d-\d\d))?$", notes, flags=re.M
    )
    if found is None:
        sys.exit(f"CHANGELOG.md has no section ## [{version}]")
    if tag and found[1] is None:
        sys.exit(
            f"CHANGELOG.md has no date behind ## [{version}], as in ## [{version}] - 2026-01-31"
        )
    if changed := run("git", "status", "--porcelain", cwd=ROOT):
        sys.exit(f"not committed:\n{changed}")
    epoch = run("git", "log", "-1", "--format=%ct", cwd=ROOT)
    with tempfile.TemporaryDirectory() as first, tempfile.TemporaryDirectory() as second:
        made = [build(Path(folder), epoch) for folder in (first, second)]
        for one, other in zip(*made, strict=True):
            if digest(one) != digest(other):
                sys.exit(f"{one.name}: the second build has other bytes")
        folder = Path(target)
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        for path in made[0]:
            shutil.copyfile(path, folder / path.name)
            print(f"{folder / path.name}: {path.stat().st_size / 1e6:.2f} MB, built twice alike")


def build(folder: Path, epoch: str) -> list[Path]:
    """The wheel and the sdist of the commit, from a copy of it in a folder."""
    tree, made = folder / "tree", folder / "made"
    tree.mkdir()
    archive = subprocess.run(["git", "archive", "HEAD"], cwd=ROOT, check=True, capture_output=True)
    with tarfile.open(fileobj=io.BytesIO(archive.stdout)) as files:
        files.extractall(tree, filter="tar")
    environment = {
        **os.environ,
        "SOURCE_DATE_EPOCH": epoch,
        "PYTHONPATH": str(tree / "build" / "types"),
        "DUHAMEL_CACHE": str(folder / "cache"),
        "PYTHONHASHSEED": "0",
    }
    run("make", "build/types/.linked", cwd=tree, env=environment)
    steps = "tools/make_shipped_steps.py"
    run(sys.executable, steps, "--derivatives", cwd=tree, env=environment)
    for kind in ("wheel", "sdist"):
        program = f"from setuptools import build_meta; build_meta.build_{kind}({str(made)!r})"
        run(sys.executable, "-c", program, cwd=tree, env=environment)
    (sdist,) = made.glob("*.tar.gz")
    normalize(sdist, int(epoch))
    return sorted(made.iterdir())


def normalize(sdist: Path, epoch: int) -> None:
    """Write an sdist anew with the entries in order, without owners, and all of one time."""
    content = io.BytesIO()
    with tarfile.open(sdist) as old, tarfile.open(fileobj=content, mode="w") as new:
        for entry in sorted(old.getmembers(), key=lambda entry: entry.name):
            entry.mtime, entry.uid, entry.gid, entry.uname, entry.gname = epoch, 0, 0, "", ""
            entry.mode = 0o755 if entry.isdir() or entry.mode & 0o100 else 0o644
            entry.pax_headers = {}
            new.addfile(entry, old.extractfile(entry) if entry.isfile() else None)
    with sdist.open("wb") as raw, gzip.GzipFile("", "wb", fileobj=raw, mtime=epoch) as packed:
        packed.write(content.getvalue())


def digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def run(*command: str, **options: object) -> str:
    """What a command prints; its errors, and the end of this program, where it fails."""
    done = subprocess.run(command, capture_output=True, text=True, **options)  # type: ignore[call-overload]
    if done.returncode:
        sys.exit(f"{' '.join(command)}:\n{done.stdout}{done.stderr}")
    return str(done.stdout).strip()


if __name__ == "__main__":
    os.umask(0o022)
    main(*sys.argv[1:])
