"""From a body file to a superelement file, with its provenance; and the two bars that stand for
each other.
"""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from duhamel.preprocess import build, read_body
from duhamel.superelement import read, sha256, write

MESHES = Path(__file__).parents[2] / "meshes"


@pytest.fixture(scope="module")
def paper():
    return build(read_body(MESHES / "beam" / "beam.toml"))


@pytest.fixture(scope="module")
def bars():
    """The line and the solid bar; few steps, for the kernels are not looked at."""
    made = []
    for name in ("beam", "solid"):
        body = read_body(MESHES / "bar" / f"{name}.toml")
        made.append(
            build(body.model_copy(update={"impulse": body.impulse.model_copy(update={"steps": 2})}))
        )
    return made


def test_the_papers_beam(paper):
    assert paper.name == "beam"
    assert paper.mass == pytest.approx(0.0429, rel=1e-12)
    assert [interface.name for interface in paper.interfaces] == ["root", "tip"]
    np.testing.assert_allclose(paper.interface("tip").X, [0.25, 0, 0], rtol=0, atol=1e-15)
    np.testing.assert_allclose(paper.center, [0.25, 0, 0], rtol=0, atol=1e-15)
    assert (paper.kernel.h, paper.kernel.steps, paper.kernel.error) == (6e-5, 5000, 0.0)
    np.testing.assert_allclose(
        paper.modes.frequencies[:6:2], [114.041, 314.427, 616.815], rtol=1e-5
    )


def test_provenance(paper):
    provenance = paper.provenance
    assert provenance.body == (MESHES / "beam" / "beam.toml").read_text()
    assert provenance.mesh == "beam.msh"
    assert provenance.mesh_sha256 == sha256(MESHES / "beam" / "beam.msh")
    assert (provenance.method, provenance.tolerance) == ("modal", 0.0)
    assert set(provenance.versions) == {
        "duhamel",
        "numpy",
        "scipy",
        "scikit-fem",
        "meshio",
        "rslab",
    }
    assert provenance.versions["numpy"] == np.__version__
    assert list(provenance.timings) == ["mesh", "assembly", "impulse", "static"]


def test_the_file_holds_it_all(paper, tmp_path):
    write(tmp_path / "beam.h5", paper)
    again = read(tmp_path / "beam.h5")
    assert np.array_equal(again.kernel.g, paper.kernel.g)
    assert again.provenance == paper.provenance


def test_progress_goes_to_the_error_stream_and_changes_nothing(beam_body, beam, capsys):
    body = beam_body(beam(3), impulse={"step": 1e-4, "steps": 50, "method": "march"})
    quiet = build(body)
    assert capsys.readouterr() == ("", "")
    shown = build(body, progress=True)
    assert capsys.readouterr().out == ""
    assert np.array_equal(shown.kernel.g, quiet.kernel.g)


@pytest.mark.parametrize(
    ("folder", "names"), [("beam", ["beam.msh"]), ("bar", ["beam.msh", "solid.msh"])]
)
def test_the_scripts_make_the_meshes_that_are_kept(folder, names, tmp_path):
    script = tmp_path / "make_mesh.py"
    script.write_text((MESHES / folder / "make_mesh.py").read_text())
    subprocess.run([sys.executable, str(script)], check=True)
    for name in names:
        assert (tmp_path / name).read_bytes() == (MESHES / folder / name).read_bytes()


def test_beams_need_no_solid_elements():
    """scikit-fem is slow to import; who has lines only does not wait for it."""
    program = (
        "import sys, duhamel.preprocess as p;"
        f"p.assemble(p.read_body(r'{MESHES / 'beam' / 'beam.toml'}'));"
        "sys.exit('skfem' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


def test_two_meshes_of_one_bar_have_its_mass_and_inertia(bars):
    """m (b^2 + c^2) / 12 of the box; the line has it through its rotary inertias."""
    L, b, h = 0.5, 0.02, 0.01
    mass = 2700.0 * L * b * h
    inertia = mass / 12 * np.array([b**2 + h**2, L**2 + h**2, L**2 + b**2])
    for bar in bars:
        assert bar.mass == pytest.approx(mass, rel=1e-12)
        np.testing.assert_allclose(bar.J_rot, np.diag(inertia), rtol=0, atol=1e-12 * inertia.max())
        np.testing.assert_allclose(bar.center, [L / 2, 0, 0], rtol=0, atol=1e-14)


def test_two_meshes_of_one_bar_meet_others_at_the_same_frames(bars):
    beam, solid = bars
    for mine, other in zip(beam.interfaces, solid.interfaces, strict=True):
        assert (mine.name, mine.rotations) == (other.name, other.rotations)
        np.testing.assert_allclose(mine.X, other.X, rtol=0, atol=1e-14)


def test_two_meshes_of_one_bar_vibrate_alike(bars):
    """Flat and upright bending in turn: the first within 1e-3, the fifth within 1 %, the first
    torsion within 0.5 %.
    """
    beam, solid = (bar.modes.frequencies[:9] for bar in bars)
    difference = solid / beam - 1
    assert np.abs(difference[:2]).max() < 1e-3
    assert np.abs(difference).max() < 1.1e-2
    torsion = 0.5 / 0.5 * np.sqrt(120.35877796168799 / 2.25e-5)
    assert beam[7] == pytest.approx(torsion, rel=2e-3)
    assert np.abs(difference[7]) < 5e-3


def test_two_meshes_of_one_bar_deform_alike(bars):
    """Static compliance: bending and stretch within 0.15 %, torsion within 1 %, for the ends of a
    solid warp freely.
    """
    beam, solid = (bar.compliance for bar in bars)
    scale = np.sqrt(np.outer(np.diag(beam), np.diag(beam)))
    difference = np.abs(solid - beam) / scale
    twist = np.ix_([3, 9], [3, 9])
    assert difference[twist].max() < 1e-2
    difference[twist] = 0.0
    assert difference.max() < 1.5e-3
