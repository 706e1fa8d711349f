"""A superelement as notebooks show it."""

from dataclasses import replace

import numpy as np
from duhamel.superelement import (
    GeneralizedAlpha,
    Interface,
    Modes,
    Provenance,
    Superelement,
    sample_kernel,
)


def element(name="beam"):
    modes = Modes(2.0 * np.pi * np.array([100.0, 300.0]), [0.01, 0.01], np.ones((6, 2)))
    return Superelement(
        name=name,
        mass=1.5,
        J_rot=np.diag([1.0, 2.0, 1.5]),
        center=np.zeros(3),
        interfaces=(Interface("root <b>", [-0.25, 0, 0]),),
        kernel=sample_kernel(modes, 1e-4, GeneralizedAlpha(0.8), 40, error=3e-7),
        modes=modes,
        compliance=np.eye(6),
        accelerance=np.eye(6),
        provenance=Provenance(method="krylov"),
    )


def test_it_tells_mass_interfaces_frequencies_method_and_error():
    shown = element()._repr_html_()
    for text in ("beam", "1.5 kg", "100, 300 Hz", "krylov", "3e-07", "samples, 0.0001 s apart"):
        assert text in shown


def test_names_are_text():
    shown = element("<script>")._repr_html_()
    assert "<script>" not in shown
    assert "<b>" not in shown


def test_it_is_one_line():
    assert repr(element()) == "<Superelement 'beam': 1.5 kg, at root <b>, 2 modes>"


def test_one_without_modes_is_shown_too():
    measured = replace(element(), modes=None)
    assert "none: its step is fixed" in measured._repr_html_()
    assert repr(measured).endswith("0 modes>")
