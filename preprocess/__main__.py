"""`mpiexec -n N python -m duhamel.preprocess BODY.toml`; without mpiexec, `duhamel preprocess`."""

import sys

if __name__ == "__main__":
    from ..cli import app

    app(["preprocess", *sys.argv[1:]], prog_name="duhamel")
