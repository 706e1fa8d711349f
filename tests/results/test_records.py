"""The records of quantities: whole, without doubles, and the same in the documentation."""

import ast
import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from duhamel.results import motion
from duhamel.results.batches import FURTHER_WORKS
from duhamel.results.contents import table
from duhamel.results.dimensions import DIMENSIONS
from duhamel.results.quantity import readable
from duhamel.results.rotations import apply_tangent
from duhamel.solver import ModelError, read_model
from duhamel.solver.lower.allocation import make_output as make_room
from duhamel.solver.lower.lower import lower
from duhamel.solver.output import columns
from duhamel.solver.step.rotations import tangent
from duhamel.solver.step.system import Output

from .writing import batch, make_contents, make_output

MIXED = ("stop", "motor", "coupler")
"""dimensions of which some entries are lengths, others angles"""
DOCUMENT = Path(__file__).parents[2] / "docs" / "file-formats.md"


def test_every_field_of_the_output_is_recorded_once_for_each_kind_of_owner():
    taken = [
        (quantity.source, quantity.owned and quantity.owned.name)
        for quantity in motion.QUANTITIES
        if quantity.source
    ]
    assert len(set(taken)) == len(taken)
    assert {source for source, _ in taken} | set(FURTHER_WORKS) == set(Output.layout)


def test_names_dimensions_and_units():
    names = [quantity.name for quantity in motion.QUANTITIES]
    assert len(set(names)) == len(names)
    assert not set(names[1:]) & set(DIMENSIONS)  # netCDF takes these for coordinates
    for quantity in motion.QUANTITIES:
        assert quantity.dimensions[0] == "time"
        assert set(quantity.dimensions) <= set(DIMENSIONS)
        assert (quantity.source == "") == (quantity.derive is not None)
        owned = quantity.owned
        angular = bool(owned and (owned.ragged or owned.name in MIXED))
        assert angular or isinstance(quantity.unit, str)
        assert isinstance(quantity.unit, tuple) or not quantity.owned or not quantity.owned.ragged
        for unit in quantity.unit if isinstance(quantity.unit, tuple) else (quantity.unit,):
            known = r"1|s-[12]|(kg|m2?|N|J|W|Pa|rad|s)( (m2?|s))?( s| ?s-[12])?"
            assert re.fullmatch(known, unit), unit


def described():
    """The fields of the classes of motion.py that are quantities: class, field, the text below."""
    for node in ast.parse(Path(motion.__file__).read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ClassDef):
            for field, below in pairwise(node.body):
                if isinstance(field, ast.AnnAssign) and field.value is not None:
                    known = isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant)
                    text = " ".join(below.value.value.split()) if known else ""
                    yield node.name, field.target.id, text


@pytest.mark.parametrize(("kind", "field", "text"), tuple(described()))
def test_editors_show_what_the_record_says(kind, field, text):
    """The strings below fields are for editors, which cannot read records."""
    if not field.startswith("_"):
        record = vars(getattr(motion, kind))[field]
        assert text.startswith(repr(record))


def test_every_quantity_is_a_field():
    fields = {(getattr(motion, kind).group, field) for kind, field, _ in described()}
    for quantity in motion.QUANTITIES[1:]:
        if "{}" not in quantity.attribute and quantity.name != "spring_coordinate":
            assert (quantity.group, quantity.attribute) in fields


@pytest.mark.parametrize(
    ("unit", "read"),
    [
        ("m", "m"),
        ("1", "1"),
        ("s-1", "1/s"),
        ("m s-1", "m/s"),
        ("rad s-2", "rad/s²"),
        ("N m s", "N m s"),
        ("kg m2 s-1", "kg m²/s"),
        ("Pa s-2", "Pa/s²"),
    ],
)
def test_units_as_a_person_writes_them(unit, read):
    assert readable(unit) == read


def test_the_documentation_has_the_table():
    assert table() in DOCUMENT.read_text(encoding="utf-8")


def test_derived_energies():
    output = make_output(make_contents(), 5)
    found = batch(output, 0, 5)
    kinetic, elastic, springs = output.kinetic_energy, output.elastic_energy, output.spring_energy
    potential, work = output.potential_energy, output.external_work
    by_name = {quantity.name: quantity for quantity in motion.QUANTITIES}
    axes = make_contents().axes
    dissipated = by_name["dissipated_energy"].take(found, axes)
    by_springs = -output.compliance_work - springs + 2.0
    np.testing.assert_allclose(dissipated, by_springs + output.modal_damping, atol=1e-14)
    numerical = by_name["numerical_dissipation"].take(found, axes)
    np.testing.assert_allclose(numerical, output.modal_loss - output.modal_damping, atol=1e-14)
    balance = by_name["energy_balance"].take(found, axes)
    total = kinetic + elastic + springs + potential - (0.0 + 1.0 + 2.0 + 3.0)
    np.testing.assert_allclose(balance, total + dissipated + numerical - work, atol=1e-13)


def test_the_tangent_of_rotation_vectors_is_that_of_the_time_loop():
    rng = np.random.default_rng(0)
    w = rng.normal(size=(60, 3)) * np.logspace(-9, 1, 60)[:, None]
    a, T = rng.normal(size=(60, 3)), np.empty((3, 3))
    for found, vector, rotation in zip(apply_tangent(w, a), a, w, strict=True):
        tangent(rotation, T)
        np.testing.assert_allclose(found, T @ vector, rtol=0, atol=1e-14)


def test_outputs_by_name_are_views_of_the_output(tmp_path):
    """Those of a `Simulator`, which the time loop fills anew in every step."""
    (tmp_path / "arm.toml").write_text(ARM)
    compiled = lower(read_model(tmp_path / "arm.toml"))
    output = make_room(compiled, 1)
    names = columns.available(compiled)
    found = {name: columns.views(compiled, name, output) for name in names}
    arrays = [array for array in output.arrays() if array.size]
    for parts in found.values():
        assert all(part.ndim == 1 for part in parts)
        for part in parts:
            assert any(np.shares_memory(part, array) for array in arrays) or not part.size
    shapes = {name: sum(map(len, parts)) for name, parts in found.items()}
    expected = {
        "bodies/arm/v": 6,
        "frames/arm.end/rotation": 4,
        "joints/pin/multipliers": 5,
        "joints/pin/angle": 1,
        "joints/pin/angle_rate": 1,
        "springs/coil/coordinates": 1,
        "energy/work": 1,
        "momentum/angular": 3,
        "solver/iterations": 1,
    }
    assert {name: shapes[name] for name in expected} == expected
    for wrong in ("energy/balance", "energy/modal", "bodies/arm", "joints/pin/angel", "x"):
        with pytest.raises(ModelError, match=f"outputs: no '{wrong}'"):
            columns.views(compiled, wrong, output)


ARM = """
[simulation]
t_end = 0.01
step = 1e-3

[bodies.arm]
mass = 1.0
inertia = [1, 1, 1]
frames.pin = {position = [-0.5, 0, 0]}
frames.end = {position = [0.5, 0, 0]}

[[joints]]
name = "pin"
type = "revolute"
between = ["ground", "arm.pin"]
axis = [0, 0, 1]

[[springs]]
name = "coil"
type = "torsion"
between = ["ground", "arm.pin"]
axis = [0, 0, 1]
stiffness = 2
"""
