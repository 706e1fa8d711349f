"""Flexible pendulums against a geometrically exact beam code (Exudyn, ANCF cable elements).

One beam, and two, of the paper (L = 0.5 m, EI = 5.5 N m^2, EA = 2.16e7 N, 0.0858 kg/m) hang from a
pivot, start straight, unloaded and at rest along x, and fall under gravity along -y for a second;
the beams ring as they fall.

The tips of the paper's beams stay within 5e-5 L of the reference; beams that do not bend miss it by
1.2e-4 L (one) and 9e-4 L (two). What is left has two parts: a superelement is linear in its own
frame, without geometric stiffening, so that beams of two superelements each come more than twice as
near; and steps of 1e-4 s leave 1e-5 L, as in Exudyn.

Beams that are 16 times softer swing up to 1.4 % of L away from rigid ones. There the first part is
all, and falls with the square of the length of the superelements. Over tips and time, in L:

    superelements in a beam              rigid      1          2          4
    one beam     root mean square        1.0e-3     4.7e-4     1.1e-4     3.0e-5
                 largest                 2.0e-3     1.1e-3     2.7e-4     7.6e-5
    two beams    root mean square        4.4e-3     6.3e-4     1.5e-4     4.0e-5
                 largest                 1.4e-2     2.5e-3     6.1e-4     1.7e-4

With [rotation] one superelement a beam is enough: 1.1e-6 L and 1.2e-6 L with steps of 5e-5 s.
"""

import numpy as np
import pytest

pytest.importorskip("exudyn")

from duhamel.solver import (
    Fixed,
    FlexibleBody,
    Frame,
    Model,
    Place,
    Revolute,
    RigidBody,
    Settings,
    Start,
    simulate,
)

from .exudyn_beam import EA, EI, L, m
from .exudyn_pendulum import pendulum
from .straight_beam import along, beam_superelement

ELEMENTS = 16
SECTION = {
    "EA": EA,
    "EI_y": EI,
    "EI_z": EI,
    "GJ": 4.0,
    "mass_per_length": m,
    "polar_inertia_per_length": 4.4e-8,
}
SOFT = EI / 16
FOUR = {1: 3.0e-5, 2: 4.0e-5}
"""root mean square with four superelements in each of so many soft beams, over L"""
T_END, STEP = 1.0, 1e-4


def superelement(folder, parts, stiffness=EI, **settings):
    """One of the equal superelements that make up a beam; settings: of the body file."""
    section, elements = SECTION | {"EI_y": stiffness, "EI_z": stiffness}, ELEMENTS // parts
    interfaces = {"root": 0, "tip": elements}
    return beam_superelement(folder, along(L / parts, elements), section, interfaces, **settings)


@pytest.fixture(scope="module")
def parts(tmp_path_factory):
    """Superelements that make up a beam, by their number in it."""
    return {parts: superelement(tmp_path_factory.mktemp(f"beam{parts}"), parts) for parts in (1, 2)}


def elastic(part, start):
    return FlexibleBody(part, start)


def rigid(part, start):
    return RigidBody(part.mass, part.J_rot, {i.name: Frame(i.X) for i in part.interfaces}, start)


def motion(body, part, beams, parts, t_end=T_END, step=STEP):
    """Results, and positions of the tips of the beams (n_t, beams, 2); each beam has `parts` bodies
    in a row.
    """
    n = beams * parts
    places = [Start(position=[0.5 * L / parts, 0, 0])]
    places += [Start(place=Place("root", f"b{i}.tip")) for i in range(n - 1)]
    supports = ["ground", *(f"b{i}.tip" for i in range(n - 1))]
    joints = tuple(
        Fixed(support, f"b{i}.root", name=f"j{i}")
        if i % parts
        else Revolute(support, f"b{i}.root", [0, 0, 1], name=f"j{i}")
        for i, support in enumerate(supports)
    )
    model = Model(
        bodies={f"b{i}": body(part, place) for i, place in enumerate(places)},
        joints=joints,
        gravity=[0, -9.81, 0],
        settings=Settings(t_end=t_end, step=step, rho_inf=0.9),
    )
    results = simulate(model)
    tips = [results.frame(f"b{i}.tip").position[:, :2] for i in range(parts - 1, n, parts)]
    return results, np.stack(tips, axis=1)


@pytest.fixture(scope="module", params=[1, 2], ids=["one beam", "two beams"])
def reference(request):
    """Positions of the tips at the steps (n_t, beams, 2); Exudyn takes half a step at a time."""
    return pendulum(request.param, T_END, 0.5 * STEP).ends[::2, :, 1]


def distances(tips, reference):
    """Over the length of a beam: the largest of each tip (beams,), and the root mean
    square of all.
    """
    apart = np.linalg.norm(tips - reference, axis=-1) / L
    return apart.max(axis=0), np.sqrt((apart**2).mean())


def test_the_first_fifth_of_a_second(parts):
    """Ten times nearer to the reference than a beam that does not bend."""
    reference = pendulum(1, 0.2, 0.5 * STEP).ends[::2, :, 1]
    largest, _ = distances(motion(elastic, parts[1], 1, 1, 0.2)[1], reference)
    stiff, _ = distances(motion(rigid, parts[1], 1, 1, 0.2)[1], reference)
    assert largest < 1e-5 < 1e-4 < stiff


@pytest.mark.validation
def test_the_tips_move_as_those_of_a_geometrically_exact_beam(parts, reference):
    beams = reference.shape[1]
    results, tips = motion(elastic, parts[1], beams, 1)
    _, stiff_tips = motion(rigid, parts[1], beams, 1)
    _, finer_tips = motion(elastic, parts[2], beams, 2)
    (largest, mean), (stiff, _) = distances(tips, reference), distances(stiff_tips, reference)
    finer, finer_mean = distances(finer_tips, reference)
    print(
        f"{beams} beam(s): distance of tips from the reference {largest} L; of rigid beams "
        f"{stiff} L"
    )
    print(
        f"with two superelements each {finer} L; root mean squares {mean:.1e} and "
        f"{finer_mean:.1e} L"
    )
    print(f"{results.iterations.mean():.2f} iterations per step, {results.solver['seconds']:.2f} s")
    assert (largest < 5e-5).all()
    assert (stiff > 1e-4).all()
    assert finer_mean < 0.5 * mean


@pytest.mark.validation
@pytest.mark.parametrize(
    ("beams", "numbers", "nearer"), [(1, (1, 2, 4), 30), (2, (1, 2), 25)], ids=["one", "two"]
)
def test_soft_pendulums_converge_with_the_number_of_superelements(
    beams, numbers, nearer, tmp_path_factory
):
    """Four times nearer with each doubling, until they are `nearer` times as near as beams that do
    not bend.
    """
    reference = pendulum(beams, T_END, 0.5 * STEP, stiffness=SOFT).ends[::2, :, 1]
    means = []
    for n in numbers:
        part = superelement(tmp_path_factory.mktemp(f"soft{n}"), n, SOFT)
        if n == 1:
            _, stiff_mean = distances(motion(rigid, part, beams, 1)[1], reference)
        largest, mean = distances(motion(elastic, part, beams, n)[1], reference)
        print(
            f"{beams} soft beam(s), {n} superelement(s) each: largest {largest} L, root mean "
            f"square {mean:.1e} L"
        )
        means.append(mean)
    assert (np.array(means[:-1]) > 3.5 * np.array(means[1:])).all()
    assert stiff_mean > nearer * means[-1]


@pytest.mark.validation
@pytest.mark.parametrize("beams", [1, 2])
def test_one_body_of_second_order_is_twice_as_near_as_four_of_first(beams, tmp_path):
    """With half the step, so that what steps leave does not cover it."""
    step = 0.5 * STEP
    reference = pendulum(beams, T_END, 0.5 * step, stiffness=SOFT).ends[::2, :, 1]
    part = superelement(tmp_path, 1, SOFT, rotation={"modes": 4})
    results, tips = motion(elastic, part, beams, 1, step=step)
    largest, mean = distances(tips, reference)
    print(
        f"{beams} soft beam(s), one body of second order each: largest {largest} L, root mean "
        f"square {mean:.1e} L; {results.iterations.mean():.2f} iterations"
    )
    assert mean < 0.1 * FOUR[beams]
