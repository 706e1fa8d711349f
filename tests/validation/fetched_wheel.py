"""Wheels of PyPI that are fetched at each run, by their digests, and never installed."""

import subprocess
import sys
import zipfile

import pytest


def fetched_wheel(folder, requirement):
    """The wheel of a requirement with its digest, open."""
    (folder / "wanted.txt").write_text(f"{requirement}\n")
    pip = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--no-input"]
    asked = ["--require-hashes", "--dest", str(folder), "-r", str(folder / "wanted.txt")]
    done = subprocess.run([*pip, *asked], capture_output=True, text=True, check=False)
    if done.returncode:
        # Not there to be tried, which --complete makes an error, as with peers.
        pytest.skip(f"{requirement.split()[0]}: {done.stderr.strip() or 'not fetched'}")
    (path,) = folder.glob("*.whl")
    return zipfile.ZipFile(path)
