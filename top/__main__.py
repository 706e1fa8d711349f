"""`python -m duhamel`, where the command is not on the path."""

from duhamel.cli import app

app(prog_name="duhamel")
