"""`mpiexec -n N python -m duhamel.preprocess BODY.toml`; without mpiexec, `duhamel preprocess`."""

import sys


def main() -> None:
    from .. import cli

    cli.app(["preprocess", *sys.argv[1:]], prog_name="duhamel")


if __name__ == "__main__":
    main()
