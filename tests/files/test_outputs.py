"""Outputs appear whole, through links, over no input, and what dead processes left is removed."""

import os
import subprocess
import sys

import pytest
from duhamel.files import OverwriteError, renamed_when_whole, require_no_input


def test_a_link_stays_and_leads_to_the_new_file(tmp_path):
    (tmp_path / "folder").mkdir()
    target, link = tmp_path / "folder" / "target", tmp_path / "link"
    target.write_text("old")
    link.symlink_to(target)
    with renamed_when_whole(link) as temporary:
        assert temporary.parent == target.parent
        temporary.write_text("new")
    assert link.is_symlink()
    assert target.read_text() == "new"
    assert os.listdir(target.parent) == ["target"]


def test_what_a_killed_process_left_is_removed_by_the_next_write(tmp_path):
    path = tmp_path / "body.h5"
    program = (
        "import os, signal, sys\n"
        "from pathlib import Path\n"
        "from duhamel.files import renamed_when_whole\n"
        "with renamed_when_whole(Path(sys.argv[1])) as temporary:\n"
        "    temporary.write_text('half')\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    subprocess.run([sys.executable, "-c", program, path], check=False)
    (left,) = os.listdir(tmp_path)
    with renamed_when_whole(path) as temporary:
        assert not (tmp_path / left).exists()
        with renamed_when_whole(path) as other:  # that of a living process stays
            assert temporary.exists()
            other.write_text("first")
        temporary.write_text("whole")
    assert os.listdir(tmp_path) == ["body.h5"]
    assert path.read_text() == "whole"


@pytest.mark.parametrize("name", ["n" * 250, "\N{CJK UNIFIED IDEOGRAPH-4E00}" * 83])
def test_the_temporary_file_of_a_long_name_is_not_too_long(name, tmp_path):
    path = tmp_path / name
    with renamed_when_whole(path) as temporary:
        temporary.write_text("whole")
    assert path.read_text() == "whole"


@pytest.mark.parametrize("alias", ["same", "link", "hard link", "other path"])
def test_an_output_in_the_place_of_an_input_is_refused(alias, tmp_path):
    mesh = tmp_path / "a.h5"
    mesh.write_text("mesh")
    output = {
        "same": mesh,
        "link": tmp_path / "link",
        "hard link": tmp_path / "hard",
        "other path": tmp_path / "x" / ".." / "a.h5",
    }[alias]
    (tmp_path / "x").mkdir()
    if alias == "link":
        output.symlink_to(mesh)
    if alias == "hard link":
        os.link(mesh, output)
    with pytest.raises(OverwriteError, match=f"^{output} is the input {mesh}, which the output"):
        require_no_input(output, [tmp_path / "missing", mesh])


def test_other_outputs_are_allowed(tmp_path):
    (tmp_path / "a.h5").touch()
    (tmp_path / "b.h5").touch()
    require_no_input(tmp_path / "b.h5", [tmp_path / "a.h5", tmp_path / "none"])
    require_no_input(tmp_path / "none", [tmp_path / "none"])
