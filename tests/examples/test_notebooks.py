"""The notebooks run from the first cell to the last, and draw."""

from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.py"))


@pytest.mark.parametrize("script", NOTEBOOKS, ids=lambda path: path.stem)
@pytest.mark.filterwarnings("default")  # of Jupyter
def test_a_notebook_runs(script: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for needed in ("jupytext", "nbclient", "ipykernel"):
        pytest.importorskip(needed)
    from run_notebooks import run

    monkeypatch.delenv("MPLBACKEND", raising=False)  # pictures go into the notebook
    notebook = run(script, tmp_path / "run.ipynb")
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert any("image/png" in output.get("data", {}) for output in outputs)


def test_there_are_notebooks() -> None:
    assert len(NOTEBOOKS) >= 3
