"""A bracket from its hammer test beside its mesh, in a mechanism."""

from duhamel import preprocess


def test_a_bracket_from_its_test_is_struck_as_its_mesh(example, tmp_path):
    found = example("measured_bracket").main(tmp_path)  # which checks forces and motions
    assert (tmp_path / "measured-bracket.png").stat().st_size
    # What the test has wrong is across the plane of symmetry, where the mesh has nothing.
    assert 0.1 < found.across < 0.5


def test_the_mesh_is_what_its_script_says(example):
    body = preprocess.read_body(example("measured_bracket").BODY)
    structure = preprocess.assemble(body)
    volume = 1e-9 * 50.0 * (300 * 10 + 140 * 10 + 40 * 20 + 15 * 35)
    assert abs(structure.rigid.mass / (7850.0 * volume) - 1.0) < 1e-12
