"""The JSON schemas of body, model and study files, in schemas/: `python tools/make_schemas.py`."""

import json
from pathlib import Path

from duhamel.cli.commands.schema import schema_of

FOLDER = Path(__file__).resolve().parents[1] / "schemas"


def text(kind: str) -> str:
    """A schema as its file has it."""
    return f"{json.dumps(schema_of(kind), indent=2)}\n"


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for kind in ("body", "tested", "model", "study"):
        (FOLDER / f"{kind}.json").write_text(text(kind), encoding="utf-8")
