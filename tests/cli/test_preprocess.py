"""`duhamel preprocess`: where the file goes, what is printed, and how it fails."""

import importlib
import sys

import meshio
import numpy as np
import pytest
from duhamel.cli import app
from duhamel.preprocess import MethodError
from duhamel.superelement import read

BODY = """
name = "rod"
mesh = "mesh.vtk"

[section]
EA = 2.16e7
EI_y = 5.5
EI_z = 5.5
GJ = 4.0
mass_per_length = 0.0858
polar_inertia_per_length = 4.4e-8

[interfaces.root]
node = [0, 0, 0]

[impulse]
step = 1e-4
steps = 20
"""


@pytest.fixture
def body_file(tmp_path):
    points = np.column_stack([np.linspace(0, 0.5, 5), np.zeros(5), np.zeros(5)])
    lines = np.column_stack([np.arange(4), np.arange(1, 5)])
    meshio.write_points_cells(tmp_path / "mesh.vtk", points, [("line", lines)])
    (tmp_path / "body.toml").write_text(BODY)
    return tmp_path / "body.toml"


def test_the_file_stands_beside_the_body_file_and_has_its_name(runner, body_file):
    result = runner.invoke(app, ["preprocess", str(body_file)])
    target = body_file.with_name("body.h5")
    assert result.exit_code == 0, result.output
    last = result.stdout.splitlines()[-1]
    assert last.startswith(f"{target}: 6 dofs, {target.stat().st_size / 1e6:.3g} MB, ")
    assert last.endswith(" s")
    assert read(target).mass == pytest.approx(0.0858 * 0.5, rel=1e-12)


def test_truncated_modes_say_how_far_they_are_right(runner, body_file):
    body_file.write_text(BODY.replace("steps = 20", 'steps = 20\nmethod = "rubin"\nmodes = 4'))
    result = runner.invoke(app, ["preprocess", str(body_file)])
    assert result.exit_code == 0, result.output
    kernel = read(body_file.with_name("body.h5")).kernel
    told = f"rubin with 4 modes: error {kernel.error:.2g} up to {kernel.band:.5g} Hz"
    assert result.stdout.splitlines()[-2] == told
    shown = runner.invoke(app, ["info", str(body_file.with_name("body.h5"))]).stdout
    assert "rubin with 4 modes, tolerance 0.01" in shown
    checked = runner.invoke(app, ["check", str(body_file.with_name("body.h5"))])
    assert checked.exit_code == 0, checked.output


def test_more_modes_than_the_mesh_has_are_one_line(runner, body_file):
    body_file.write_text(BODY.replace("steps = 20", 'steps = 20\nmethod = "rubin"\nmodes = 25'))
    result = runner.invoke(app, ["preprocess", str(body_file)])
    assert result.exit_code == 1
    told = f"error: {body_file}: impulse.modes: expected 1 to 24, all of this mesh, found 25"
    assert result.stderr.strip() == told
    assert not body_file.with_name("body.h5").exists()


def test_the_file_goes_where_it_is_sent(runner, body_file):
    target = body_file.with_name("elsewhere.h5")
    result = runner.invoke(app, ["preprocess", str(body_file), "-o", str(target)])
    assert result.exit_code == 0, result.output
    assert sorted(path.name for path in body_file.parent.glob("*.h5")) == ["elsewhere.h5"]


def test_what_a_mesh_loses_is_one_line_on_stderr(runner, body_file):
    nodes = "".join(f"{i + 1}, {0.125 * i}, 0, 0\n" for i in range(5))
    lines = "".join(f"{i}, {i}, {i + 1}\n" for i in range(1, 5))
    deck = f"*NODE\n{nodes}*ELEMENT, TYPE=B31\n{lines}*ELEMENT, TYPE=MASS, ELSET=tip\n9, 5\n"
    body_file.with_name("mesh.inp").write_text(deck)
    body_file.write_text(BODY.replace("mesh.vtk", "mesh.inp"))
    result = runner.invoke(app, ["preprocess", str(body_file)])
    assert result.exit_code == 0, result.output
    told = [line for line in result.stderr.splitlines() if line.strip()]
    assert told == [
        f"warning: {body_file.with_name('mesh.inp')}: left out: elements of type MASS (1)"
    ]
    assert body_file.with_name("body.h5").is_file()


def test_doubts_about_a_mesh_come_before_the_error_they_explain(runner, body_file, monkeypatch):
    """As of coordinates in millimeters, which make the build long and its error another one."""

    def fail(*_):
        raise MethodError("too much for this machine")

    module = importlib.import_module("duhamel.preprocess.build")
    monkeypatch.setattr(module, "impulse_responses", fail)
    body_file.write_text(BODY.replace("\n[section]", "scale = 1e3\n[section]"))
    result = runner.invoke(app, ["preprocess", str(body_file)])
    assert result.exit_code == 1
    doubt, *_, error = [line for line in result.stderr.splitlines() if line.strip()]
    assert doubt.startswith(f"warning: {body_file}: the mesh is 500 m large")
    assert "too much for this machine" in error


@pytest.mark.parametrize("name", ["body.toml", "mesh.vtk"])
def test_a_missing_file_is_one_line_on_stderr_and_nothing_is_written(name, runner, body_file):
    missing = body_file.with_name(name)
    missing.unlink()
    result = runner.invoke(app, ["preprocess", str(body_file)])
    assert result.exit_code == 1
    # The progress bar, which shares stderr, may end in an empty line.
    message = result.stderr.strip()
    assert message.startswith(f"error: {missing}: ")
    assert "\n" not in message
    assert list(body_file.parent.glob("*.h5")) == []


def test_a_missing_folder_for_the_result_is_one_line_on_stderr(runner, body_file):
    target = body_file.parent / "none" / "rod.h5"
    result = runner.invoke(app, ["preprocess", str(body_file), "-o", str(target)])
    assert result.exit_code == 1
    assert result.stderr.splitlines()[-1] == f"error: {target}: no folder {target.parent}"


def test_processes_without_mpi_are_one_line_that_says_what_to_install(
    runner, body_file, monkeypatch
):
    monkeypatch.setattr(
        "duhamel.preprocess.parallel.start.find_spec", lambda name: None if "mpi" in name else True
    )
    result = runner.invoke(app, ["preprocess", str(body_file), "--mpi", "2"])
    assert result.exit_code == 1
    assert result.stderr == (
        "error: MPI: expected mpi4py and petsc4py, found no mpi4py: pip install 'duhamel[mpi]' "
        "brings them for Python 3.12 and later on Linux (x86-64)\n"
    )
    assert list(body_file.parent.glob("*.h5")) == []


def test_a_dry_run_is_of_one_process(runner, body_file):
    result = runner.invoke(app, ["preprocess", str(body_file), "--mpi", "2", "--dry-run"])
    assert result.exit_code == 2
    assert "--mpi goes without --dry-run" in result.output


def test_a_dry_run_tells_and_draws_and_writes_no_superelement(runner, body_file):
    result = runner.invoke(app, ["preprocess", str(body_file), "--dry-run"])
    assert result.exit_code == 0, result.output
    picture = body_file.with_name("body.png")
    assert result.stdout.splitlines()[-1] == str(picture)
    assert picture.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert list(body_file.parent.glob("*.h5")) == []
    for words in (
        "0.0429",
        "5 nodes, 4 line",
        "30, of which 6 interface dofs",
        "one node, 6 dofs",
        "from the mesh itself",
    ):
        assert words in result.stdout


@pytest.mark.parametrize(
    ("band", "told"),
    [("band = 1250\n", "a run needs step = 4e-05 s"), ("", "")],
)
def test_a_dry_run_tells_the_step_that_a_band_needs(runner, body_file, band, told):
    """Twenty steps in the shortest period, 1 / (20 x 1250 Hz)."""
    body_file.write_text(f"{body_file.read_text()}{band}")
    result = runner.invoke(app, ["preprocess", str(body_file), "--dry-run"])
    assert ("a run needs step" in result.stdout) == bool(told)
    assert told in result.stdout


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ("modes = 3", "3 modes, up to 6 soft shapes: r up to 15"),
        ("loaded = []", "4 modes, up to 0 soft shapes: r up to 4"),
        ("soft = 2", "4 modes, up to 2 soft shapes: r up to 8"),
    ],
)
def test_a_dry_run_tells_how_many_coordinates_are_of_second_order(runner, body_file, asked, told):
    body_file.write_text(f"{body_file.read_text()}\n[rotation]\n{asked}\n")
    result = runner.invoke(app, ["preprocess", str(body_file), "--dry-run"])
    assert told in result.stdout, result.output


def test_the_picture_of_a_dry_run_goes_where_it_is_sent(runner, body_file):
    target = body_file.with_name("look.pdf")
    result = runner.invoke(app, ["preprocess", str(body_file), "--dry-run", "-o", str(target)])
    assert result.exit_code == 0, result.output
    assert target.read_bytes()[:4] == b"%PDF"


@pytest.mark.parametrize(
    ("right", "wrong", "message"),
    [
        (
            "node = [0, 0, 0]",
            "sphere = {center = [0, 0, 0], radius = 0.2}",
            "mesh.vtk: interfaces.root: expected one node",
        ),
        ("node = [0, 0, 0]", "nood = [0, 0, 0]", "body.toml: interfaces.root: unknown key 'nood'"),
    ],
)
def test_a_dry_run_fails_in_one_line_that_names_file_and_key(
    runner, body_file, right, wrong, message
):
    body_file.write_text(BODY.replace(right, wrong))
    result = runner.invoke(app, ["preprocess", str(body_file), "--dry-run"])
    assert result.exit_code == 1
    assert message in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert list(body_file.parent.glob("*.png")) == []


def test_a_picture_in_no_format_is_one_line_on_stderr(runner, body_file):
    target = body_file.with_name("body.h5")
    result = runner.invoke(app, ["preprocess", str(body_file), "--dry-run", "-o", str(target)])
    assert result.exit_code == 1
    assert f"error: {target}: expected a suffix of" in result.stderr


# Inputs are never replaced


def refused(runner, *arguments, found):
    """The command fails in one line that names the input, which stays as it was."""
    before = found.read_bytes()
    result = runner.invoke(app, ["preprocess", *map(str, arguments)])
    assert result.exit_code == 1
    (message,) = (line for line in result.stderr.splitlines() if line.strip())
    assert message.endswith(f" is the input {found}, which the output would replace")
    assert found.read_bytes() == before


def test_the_numbers_of_an_xdmf_mesh_are_not_replaced(runner, body_file):
    """meshio and dolfinx put them into NAME.h5."""
    mesh = meshio.read(body_file.with_name("mesh.vtk"))
    mesh.write(body_file.with_name("body.xdmf"))
    body_file.write_text(BODY.replace("mesh.vtk", "body.xdmf"))
    refused(runner, body_file, found=body_file.with_name("body.h5"))


@pytest.mark.parametrize("option", [[], ["--dry-run"]], ids=["build", "dry run"])
@pytest.mark.parametrize("name", ["body.toml", "mesh.vtk", "link"])
def test_body_file_and_mesh_are_not_replaced(name, option, runner, body_file):
    found = body_file.with_name("mesh.vtk" if name == "link" else name)
    body_file.with_name("link").symlink_to(body_file.with_name("mesh.vtk"))
    refused(runner, body_file, *option, "-o", body_file.with_name(name), found=found)


def test_included_files_are_not_replaced(runner, body_file):
    body_file.with_name("nodes.inp").write_text(
        "*NODE\n" + "".join(f"{i + 1}, {0.125 * i}, 0, 0\n" for i in range(5))
    )
    lines = "".join(f"{i}, {i}, {i + 1}\n" for i in range(1, 5))
    body_file.with_name("mesh.inp").write_text(
        f"*INCLUDE, INPUT=nodes.inp\n*ELEMENT, TYPE=B31\n{lines}"
    )
    body_file.write_text(BODY.replace("mesh.vtk", "mesh.inp"))
    found = body_file.with_name("nodes.inp")
    refused(runner, body_file, "-o", found, found=found)


def test_a_body_file_that_was_copied_does_not_replace_the_superelement_of_the_other(
    runner, body_file
):
    """Although both bodies have one name."""
    copy = body_file.with_name("copy.toml")
    copy.write_text(BODY)
    for file in (body_file, copy):
        assert runner.invoke(app, ["preprocess", str(file)]).exit_code == 0
    assert sorted(path.name for path in copy.parent.glob("*.h5")) == ["body.h5", "copy.h5"]


def test_a_link_in_the_place_of_the_superelement_stays(runner, body_file):
    link, target = body_file.with_name("link.h5"), body_file.with_name("target.h5")
    link.symlink_to(target)
    assert runner.invoke(app, ["preprocess", str(body_file), "-o", str(link)]).exit_code == 0
    assert link.is_symlink()
    assert read(target).name == "rod"


@pytest.mark.parametrize("name", ["n" * 300 + ".h5", "folder", "none/body.h5"])
def test_a_path_that_cannot_be_written_is_told_before_the_build(name, runner, body_file):
    """The mesh is gone, which would be the next to be told."""
    body_file.with_name("mesh.vtk").unlink()
    body_file.with_name("folder").mkdir()
    target = body_file.with_name("x").parent / name
    result = runner.invoke(app, ["preprocess", str(body_file), "-o", str(target)])
    assert result.exit_code == 1
    assert result.stderr.startswith(f"error: {target}: ")
    assert len(result.stderr.splitlines()) == 1


@pytest.mark.parametrize("earlier", [False, True])
def test_an_interrupt_says_in_which_stage_and_what_is_kept(runner, body_file, monkeypatch, earlier):
    target = body_file.with_name("body.h5")
    importlib.import_module("duhamel.preprocess")
    if earlier:
        runner.invoke(app, ["preprocess", str(body_file)])
    before = target.read_bytes() if earlier else None

    def interrupt(*arguments, **more):
        raise KeyboardInterrupt

    monkeypatch.setattr(sys.modules["duhamel.preprocess.build"], "impulse_responses", interrupt)
    result = runner.invoke(app, ["preprocess", str(body_file)])
    state = "stays as it was" if earlier else "is not written"
    told = f"interrupted in the stage impulse; {target} {state}\n"
    assert (result.exit_code, result.stderr) == (130, told)
    assert (target.read_bytes() if target.exists() else None) == before
