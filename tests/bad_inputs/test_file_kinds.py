"""Files that are given in place of others are told by what they are."""

from itertools import permutations

import pytest
from duhamel import preprocess, solver, study

MODEL = "[simulation]\nt_end = 1.0\n[bodies.hub]\nmass = 1\ninertia = [1, 1, 1]\n"
BODY = 'mesh = "arm.msh"\n[impulse]\nstep = 1e-5\n'
STUDY = 'model = "m.toml"\n[outputs]\ntop = "max |angle:hub:z|"\n'
READERS = {
    "a model file": (solver.read_model, solver.ModelError, "duhamel run", MODEL),
    "a body file": (preprocess.read_body, preprocess.BodyError, "duhamel preprocess", BODY),
    "a study file": (study.read_study, study.StudyError, "duhamel sweep, fit or optimize", STUDY),
}


@pytest.mark.parametrize(("wanted", "given"), list(permutations(READERS, 2)))
def test_a_file_of_another_kind_is_named_with_the_command_that_takes_it(tmp_path, wanted, given):
    path = tmp_path / "given.toml"
    path.write_text(READERS[given][3])
    read, failure, _, _ = READERS[wanted]
    with pytest.raises(failure) as error:
        read(path)
    found = f"expected {wanted}, found {given}: {READERS[given][2]} "
    assert str(error.value).startswith(f"{path}: {found}")


@pytest.mark.parametrize("wanted", READERS)
@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"\x89HDF\r\n\x1a\n\x00\x00", "an HDF5 file: duhamel info"),
        (b"ISO-10303-21;\nHEADER;\n", "a CAD file: duhamel import"),
        (b"\xff\xfe", "not UTF-8"),
    ],
)
def test_what_is_no_toml_is_told_by_its_first_bytes(tmp_path, wanted, content, told):
    path = tmp_path / "given.toml"
    path.write_bytes(content)
    read, failure, _, _ = READERS[wanted]
    with pytest.raises(failure, match=told):
        read(path)


def test_a_file_with_a_key_of_its_kind_is_told_of_the_others(tmp_path):
    path = tmp_path / "given.toml"
    path.write_text(MODEL + "mesh = 1\n")
    with pytest.raises(solver.ModelError, match="unknown key 'mesh'"):
        solver.read_model(path)
