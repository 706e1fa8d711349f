"""Run the notebooks and keep them with their pictures: `python tools/run_notebooks.py FOLDER`.

They are scripts of jupytext (cells begin with `# %%`), so that changes are read as text.
"""

import sys
from pathlib import Path

import jupytext
import nbformat
from nbclient import NotebookClient

NOTEBOOKS = Path(__file__).parents[1] / "notebooks"


def run(script: Path, target: Path) -> nbformat.NotebookNode:
    """The notebook of a script, with what its cells gave; written to target."""
    notebook = jupytext.read(script)
    NotebookClient(
        notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": NOTEBOOKS}}
    ).execute()
    target.parent.mkdir(parents=True, exist_ok=True)
    nbformat.write(notebook, target)
    return notebook


if __name__ == "__main__":
    for path in sorted(NOTEBOOKS.glob("*.py")):
        made = Path(sys.argv[1]) / f"{path.stem}.ipynb"
        run(path, made)
        print(made)
