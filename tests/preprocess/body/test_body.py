"""The body file: every mistake is one message that names file, key, what was found and what was
expected.
"""

from pathlib import Path

import pytest
from duhamel.preprocess import Body, BodyError, read_body
from pydantic import ValidationError

BEAM = """
name = "beam"
mesh = "meshes/beam.msh"

[section]
EA = 2.16e7
EI_y = 5.5
EI_z = 5.5
GJ = 4.0
mass_per_length = 0.0858
polar_inertia_per_length = 4.4e-8

[interfaces.root]
node = [0, 0, 0]

[interfaces.tip]
group = "tip"

[impulse]
step = 6e-5
steps = 5000
"""
SOLID = (
    BEAM[: BEAM.index("[section]")]
    + "[material]\nE = 1\nnu = 0.3\nrho = 1\n"
    + BEAM[BEAM.index("[interfaces") :]
)


@pytest.fixture
def written(tmp_path):
    def write(text):
        path = tmp_path / "body.toml"
        path.write_text(text)
        return path

    return write


def test_a_file_and_its_defaults(written):
    path = written(BEAM)
    body = read_body(path)
    assert body.mesh == path.parent / "meshes/beam.msh"
    assert body.text == BEAM
    assert body.interfaces["root"].node == (0.0, 0.0, 0.0)
    assert (body.interfaces["tip"].kind, body.interfaces["tip"].tolerance) == ("average", 1e-3)
    assert (body.impulse.rho_inf, body.impulse.method, body.impulse.tolerance) == (
        0.9,
        "auto",
        1e-6,
    )
    assert body.damping.modal is None
    assert body.damping.rayleigh is None


def test_the_same_body_in_python(written):
    body = read_body(written(BEAM))
    made = Body(
        name="beam",
        mesh=body.mesh,
        section=body.section,
        interfaces={"root": {"node": (0, 0, 0)}, "tip": {"group": "tip"}},
        impulse={"step": 6e-5, "steps": 5000},
    )
    assert made.model_dump() == body.model_dump()
    assert Body.model_validate_json(made.text) == made
    with pytest.raises(ValidationError, match="frozen"):
        made.name = "other"


def test_the_text_of_a_changed_body_tells_the_change(written):
    body = read_body(written(BEAM))
    changed = body.model_copy(update={"impulse": body.impulse.model_copy(update={"steps": 7})})
    assert Body.model_validate_json(changed.text).impulse.steps == 7
    assert body.model_copy(update={"mesh": Path("elsewhere.msh")}).text == BEAM


def test_the_same_body_with_truncated_modes(written):
    """band and tolerance are not those of such methods."""
    body = read_body(written(BEAM.replace("steps = 5000", "steps = 7\nband = 90\nrho_inf = 0.5")))
    few = body.with_modes("rubin", 16)
    assert few.impulse.model_dump(exclude_unset=True) == {
        "step": 6e-5,
        "steps": 7,
        "rho_inf": 0.5,
        "method": "rubin",
        "modes": 16,
    }
    assert Body.model_validate_json(few.text).model_dump() == few.model_dump()
    assert few.section == body.section
    with pytest.raises(ValidationError, match="expected only with method craig-bampton or rubin"):
        body.with_modes("krylov", 16)


def test_an_absolute_mesh_path_stays(written):
    body = read_body(written(BEAM.replace("meshes/beam.msh", "/data/beam.msh")))
    assert body.mesh == Path("/data/beam.msh")


MISTAKES = [
    ('name = "beam"', 'name = ""', r"name: expected 1 to 100 characters, found ''"),
    ("[section]", "[sectoin]", r"unknown key 'sectoin'; did you mean 'section'\?"),
    ("EI_y = 5.5", "EIy = 5.5", r"section: unknown key 'EIy'; did you mean 'EI_y'\?"),
    ("EI_y = 5.5", "EI_y = 5.5\nqqq = 1", r"section: unknown key 'qqq'; known are EA, EI_y"),
    ("EI_y = 5.5", "EI_y = 0.0", r"section\.EI_y: input should be greater than 0, found 0\.0"),
    ("EI_y = 5.5", "EI_y = inf", r"section\.EI_y: input should be a finite number, found inf"),
    (
        "EI_y = 5.5",
        'EI_y = "stiff"',
        r"section\.EI_y: input should be a valid number.*, found 'stiff'",
    ),
    (
        "polar_inertia_per_length = 4.4e-8",
        "polar_inertia_per_length = 0",
        r"section\.polar_inertia_per_length: .* greater than 0",
    ),
    ("GJ = 4.0", "", r"section\.GJ: missing"),
    (
        "node = [0, 0, 0]",
        "node = [0, 0]",
        r"interfaces\.root\.node: expected three numbers, found \[0, 0\]",
    ),
    (
        "node = [0, 0, 0]",
        "noode = [0, 0, 0]",
        r"interfaces\.root: unknown key 'noode'; did you mean 'node'\?",
    ),
    (
        "node = [0, 0, 0]",
        'node = [0, 0, 0]\ngroup = "a"',
        r"interfaces\.root: node stands alone, found it with group",
    ),
    (
        "node = [0, 0, 0]",
        "tolerance = 0.1",
        r"interfaces\.root: expected node, or one .* group, hole, face, plane, box, .* found none",
    ),
    (
        "node = [0, 0, 0]",
        'node = [0, 0, 0]\nkind = "rigid"',
        r"interfaces\.root: node stands alone, found it with kind",
    ),
    (
        'group = "tip"',
        'group = "tip"\nkind = "stiff"',
        r"interfaces\.tip\.kind: input should be 'average' or 'rigid', found 'stiff'",
    ),
    (
        'group = "tip"',
        "plane = {point = [0, 0, 0], normal = [0, 0, 0]}",
        r"interfaces\.tip\.plane: normal: expected a vector that is",
    ),
    (
        "[interfaces.tip]",
        '[interfaces."a.b"]',
        r"interfaces: expected a name of 1 to 100 printable characters without '\.', '/' and ':', "
        r"found 'a\.b'",
    ),
    (
        "step = 6e-5",
        "step = -1",
        r"impulse\.step: input should be greater than 0, found -1",
    ),
    ("steps = 5000", "steps = 0.5", r"impulse\.steps: .*integer.*, found 0\.5"),
    (
        "steps = 5000",
        "steps = 9\nrho_inf = 1.5",
        r"impulse\.rho_inf: .*less than or equal to 1, found 1\.5",
    ),
    (
        "steps = 5000",
        'steps = 9\nmethod = "newmark"',
        r"impulse\.method: input should be 'auto', 'modal', 'march', 'krylov', 'craig-bampton' or "
        r"'rubin', found 'newmark'",
    ),
    (
        "steps = 5000",
        'steps = 9\nmethod = "rubin"',
        r"impulse: modes: method rubin needs a number of modes, found none",
    ),
    (
        "steps = 5000",
        'steps = 9\nmethod = "craig-bampton"\nmodes = 0',
        r"impulse\.modes: input should be greater than 0, found 0",
    ),
    (
        "steps = 5000",
        "steps = 9\nmodes = 16",
        r"impulse: modes: expected only with method craig-bampton or rubin, found it with auto",
    ),
    (
        "steps = 5000",
        'steps = 9\nmethod = "rubin"\nmodes = 16\ntolerance = 1e-3\nband = 100',
        r"impulse: band and tolerance: expected only with other methods: with rubin the band and ",
    ),
    (
        "[impulse]",
        "[damping]\nmodal = -0.1\n[impulse]",
        r"damping\.modal\.ratios\.0: .*greater than or equal to 0, found -0\.1",
    ),
    (
        "[impulse]",
        "[damping]\nmodal = {frequencies = [1, 2], ratios = [0.1]}\n[impulse]",
        r"damping\.modal: expected a ratio for every frequency, found 2 frequencies and 1 ratios",
    ),
    (
        "[impulse]",
        "[damping]\nmodal = {frequencies = [2, 1], ratios = [0.1, 0.1]}\n[impulse]",
        r"damping\.modal: frequencies: expected increasing values, found \[2\.0, 1\.0\]",
    ),
    (
        "[impulse]",
        "[damping]\nmodal = 0.1\nrayleigh = {mass = 1}\n[impulse]",
        r"damping: expected one of modal, rayleigh and loss_factor, found modal and rayleigh",
    ),
    (
        "[impulse]",
        "[damping]\nrayleigh = {mass = 1, ratios = [0.1, 0.1]}\n[impulse]",
        r"damping\.rayleigh: expected mass and stiffness, or frequencies and ratios, found both",
    ),
    (
        "[impulse]",
        "[damping]\nrayleigh = {frequencies = [1, 2]}\n[impulse]",
        r"damping\.rayleigh: expected frequencies and ratios together, found one of them",
    ),
    (
        "[impulse]",
        "[damping]\nrayleigh = {frequencies = [10, 20], ratios = [0.1, 0.3]}\n[impulse]",
        r"damping\.rayleigh: ratios: expected the second 0\.5 to 2 times the first",
    ),
    (
        "[impulse]",
        "[damping]\nloss_factor = 0.1\n[impulse]",
        r"damping: band: missing, the lowest and the highest frequency \[Hz\]",
    ),
    (
        "[impulse]",
        "[damping]\nloss_factor = 0.1\nband = [100, 10]\n[impulse]",
        r"damping: band: expected two increasing frequencies, .* found \[100\.0, 10\.0\]",
    ),
    (
        "[impulse]",
        "[damping]\nloss_factor = 1\nband = [1e-3, 1e6]\n[impulse]",
        r"damping: band: a loss factor of 1 from 0\.001 to 1e\+06 Hz takes more than 30 Maxwell",
    ),
    (
        "[impulse]",
        "[damping]\nmodal = 0.1\nband = [1, 10]\n[impulse]",
        r"damping: band: belongs to loss_factor, found it with modal",
    ),
    (
        "[impulse]",
        "[damping]\nband = [1, 10]\n[impulse]",
        r"damping\.band: belongs to a loss_factor, found none",
    ),
    (
        "[section]\n",
        "[section]\nloss_factor = 0.1\n",
        r"section\.loss_factor: needs damping\.band",
    ),
    (
        "[section]",
        "[material]\nE = 1\nnu = 0.3\nrho = 1\n[section]",
        r"expected one of section, sections, material, materials, found section and material",
    ),
    ("[impulse]", "[impulse", r"not a TOML file: "),
]


@pytest.mark.parametrize(
    ("right", "wrong", "message"), MISTAKES, ids=[wrong or right for right, wrong, _ in MISTAKES]
)
def test_mistakes(written, right, wrong, message):
    assert right in BEAM
    path = written(BEAM.replace(right, wrong, 1))
    with pytest.raises(BodyError, match=rf"body\.toml: {message}") as failure:
        read_body(path)
    assert str(failure.value).count("\n") == 0


@pytest.mark.parametrize(
    ("right", "wrong", "message"),
    [
        ("nu = 0.3", "nu = 0.5", r"material\.nu: input should be less than 0\.5, found 0\.5"),
        ("nu = 0.3", "nu = -1", r"material\.nu: input should be greater than -1, found -1"),
        ("E = 1", "E = 0", r"material\.E: input should be greater than 0, found 0"),
        ("rho = 1", "rho = -1", r"material\.rho: input should be greater than 0, found -1"),
        ("[material]", "[materials.core]", None),
    ],
)
def test_materials(written, right, wrong, message):
    path = written(SOLID.replace(right, wrong))
    if message is None:
        assert read_body(path).materials["core"].nu == 0.3
        return
    with pytest.raises(BodyError, match=message):
        read_body(path)


def test_several_mistakes_are_told_together(written):
    with pytest.raises(BodyError) as failure:
        read_body(written(BEAM.replace("EA = 2.16e7", "EA = -1").replace("EI_y = 5.5", "")))
    assert len(str(failure.value).split("; ")) == 2


def test_a_body_has_the_name_of_its_file_and_steps_that_modes_continue(written):
    body = read_body(written(BEAM.replace('name = "beam"', "").replace("steps = 5000", "")))
    assert (body.name, body.impulse.steps) == ("body", 100)


def test_marched_responses_need_their_number_of_steps(written):
    text = BEAM.replace("steps = 5000", 'method = "march"')
    with pytest.raises(BodyError, match="impulse: steps: needed with method march"):
        read_body(written(text))


def test_no_file(tmp_path):
    with pytest.raises(BodyError, match=r"nowhere\.toml: not a readable file"):
        read_body(tmp_path / "nowhere.toml")
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(BodyError, match=r"binary\.toml: not a readable file"):
        read_body(tmp_path / "binary.toml")
