"""Several superelements in one model: shared files, different interfaces, steps and rho_inf."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    FlexibleBody,
    Force,
    Frame,
    Model,
    ModelError,
    Revolute,
    RigidBody,
    RigidSuperelement,
    Settings,
    Spherical,
    Start,
    Steps,
    Universal,
    read_model,
    simulate,
    write_model,
)
from duhamel.solver.lower.lower import lower
from duhamel.superelement import Outline, write

from .frameworks import bar, framework

PENDULUM = """
[simulation]
t_end = 0.1
gravity = [0, 0, -9.81]

[bodies.upper]
superelement = "upper.h5"
position = [0.15, 0, 0]

[bodies.lower]
superelement = "lower.h5"
place = {frame = "left", on = "upper.right"}

[[joints]]
name = "shoulder"
type = "revolute"
between = ["ground", "upper.left"]
axis = [0, 1, 0]

[[joints]]
name = "elbow"
type = "revolute"
between = ["upper.right", "lower.left"]
axis = [0, 1, 0]
"""


@pytest.mark.parametrize("history", ["recursive", "direct"])
def test_links_from_one_file_move_as_links_from_two(history, tmp_path):
    link = bar(tmp_path, 0.3, stiffness=0.1, steps=500)
    for name in ("link", "upper", "lower"):
        write(tmp_path / f"{name}.h5", link)
    two, one = tmp_path / "two.toml", tmp_path / "one.toml"
    two.write_text(PENDULUM)
    one.write_text(PENDULUM.replace("upper.h5", "link.h5").replace("lower.h5", "link.h5"))
    shared, copied = (read_model(path).with_settings(history=history) for path in (one, two))
    found, expected = (simulate(model).frame("lower.right").position for model in (shared, copied))
    np.testing.assert_array_equal(found, expected)
    assert np.ptp(found[:, 2]) > 0.02

    # the data of the body, be it modes or kernel, stands in memory once
    sizes = [
        sum(
            array.size
            for array in (
                elastic.modes.phi,
                elastic.kernels.g,
                elastic.kernels.g_initial,
                elastic.G_0,
            )
        )
        for elastic in (lower(model).system.elastic for model in (shared, copied))
    ]
    assert 2 * sizes[0] == sizes[1]


def chain(*elements, **settings):
    """Three bars end to end, hit sideways at the far end."""
    bodies, end = {}, np.zeros(3)
    for name, element in zip("abc", elements, strict=True):
        bodies[name] = FlexibleBody(element, Start(end - element.interface("left").X))
        end = end + element.interface("right").X - element.interface("left").X
    return Model(
        bodies=bodies,
        joints=(
            Spherical("ground", "a.left", name="A"),
            Revolute("a.right", "b.left", [0, 0, 1], name="B"),
            Universal("b.right", "c.left", [0, 1, 0], [1, 0, 0], name="C"),
        ),
        loads=(Force("c.right", [0.1, 1.0, 0.5], Steps((0.0, 0.01), (0.5, 0.0))),),
        settings=Settings(t_end=0.05, **settings),
    )


def positions(results):
    return np.hstack([results.frame(name).position for name in ("a.right", "b.right", "c.right")])


def test_superelements_of_different_size_step_and_scheme_in_one_model(tmp_path):
    """Each with its own interfaces, modes, step and rho_inf; as if all had been made for the step
    of the model.
    """
    left, middle, right = (0.0, 0.0, 0.0), (0.15, 0.0, 0.0), (0.3, 0.0, 0.0)

    def elements(*steps):
        two, three = (
            {"left": left, "right": right},
            {"middle": middle, "left": left, "right": right},
        )
        bars = [(left, middle), (middle, right)]
        wing = framework(
            tmp_path,
            [*bars, (middle, (0.15, 0.1, 0))],
            three | {"wing": (0.15, 0.1, 0)},
            step=steps[2],
        )
        return (
            framework(tmp_path, bars, two, elements=2, step=steps[0], stiffness=0.1),
            framework(tmp_path, bars, three, elements=3, step=steps[1], stiffness=0.2, steps=300),
            wing,
        )

    made_for_it = chain(*elements(2e-4, 2e-4, 2e-4), rho_inf=0.9)
    assert sorted({body.superelement.n_c for body in made_for_it.bodies.values()}) == [12, 18, 24]
    expected = positions(simulate(made_for_it))
    with pytest.raises(ModelError, match="step: the superelements differ"):
        simulate(chain(*elements(1e-3, 5e-5, 2e-4)))
    for history in ("recursive", "direct"):
        model = chain(*elements(1e-3, 5e-5, 2e-4), step=2e-4, rho_inf=0.9, history=history)
        np.testing.assert_allclose(positions(simulate(model)), expected, rtol=0, atol=1e-11)
    assert (
        np.abs(expected - positions(simulate(made_for_it.with_settings(rho_inf=0.5)))).max() > 1e-7
    )


def test_a_body_without_modes_refuses_another_step(tmp_path):
    """Among others that have modes, it alone is named."""
    measured = replace(bar(tmp_path, 0.3, step=2e-4, steps=300), name="measured", modes=None)
    others = [bar(tmp_path, 0.2), bar(tmp_path, 0.4)]
    assert len(simulate(chain(others[0], measured, others[1])).time) == 251
    message = (
        "superelement measured: no modes, so the kernel is fixed: h = 0.0002 s, rho_inf = 0.9, "
        "300 steps"
    )
    for other in ({"step": 1e-4}, {"rho_inf": 0.8}):
        with pytest.raises(ModelError, match=message):
            simulate(chain(others[0], measured, others[1], **other))


def test_a_rigid_superelement_moves_as_the_rigid_body_of_its_mass(tmp_path):
    """And has the step and the outline of the superelement, also when written and read back."""
    link = bar(tmp_path, 0.3, stiffness=0.1, steps=500)
    outline = Outline(np.eye(3), np.array([[0, 1, 2]]))
    for name in ("upper", "lower"):
        write(tmp_path / f"{name}.h5", replace(link, outline=outline))
    text = PENDULUM.replace('.h5"', '.h5"\nrigid = true')
    (tmp_path / "rigid.toml").write_text(text)
    model = read_model(tmp_path / "rigid.toml")
    assert all(isinstance(body, RigidSuperelement) for body in model.bodies.values())
    write_model(tmp_path / "again.toml", model)
    results = simulate(read_model(tmp_path / "again.toml"))
    assert results.solver["h"] == link.kernel.h
    np.testing.assert_array_equal(results.outline("lower").points, outline.points)

    frames = {interface.name: Frame(interface.X) for interface in link.interfaces}
    bodies = {
        name: RigidBody(link.mass, link.J_rot, frames, body.start)
        for name, body in model.bodies.items()
    }
    by_hand = replace(model, bodies=bodies).with_settings(step=link.kernel.h, rho_inf=0.9)
    assert link.kernel.scheme.rho_inf == 0.9
    expected = simulate(by_hand)
    np.testing.assert_array_equal(results.body("lower").x, expected.body("lower").x)
    assert np.ptp(results.body("lower").x[:, 2]) > 0.01


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        (
            'rigid = true\nsecond_order = "off"',
            "second_order belongs to flexible bodies, found rigid",
        ),
        ("rigid = 1", "bodies.upper.rigid: .* found 1"),
        ("rigid = true\nmass = 1.0", "the superelement already gives mass"),
    ],
)
def test_what_a_rigid_superelement_cannot_have_is_refused(tmp_path, keys, message):
    (tmp_path / "rigid.toml").write_text(PENDULUM.replace('upper.h5"', f'upper.h5"\n{keys}'))
    with pytest.raises(ModelError, match=message):
        read_model(tmp_path / "rigid.toml")
