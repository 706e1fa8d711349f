"""The HDF5 file: the same bits come back, whole or not at all, and each fault has its message."""

import dataclasses
import os
import subprocess
import sys
from dataclasses import replace
from typing import Any

import h5py
import numpy as np
import pytest
from duhamel.superelement import (
    GeneralizedAlpha,
    Interface,
    Modes,
    Outline,
    Provenance,
    Recovery,
    Superelement,
    SuperelementError,
    read,
    sample_kernel,
    sha256,
    write,
)
from duhamel.superelement.fields import CHUNK_BYTES

from .rotations import any_rotation


def assert_identical(found: Any, expected: Any) -> None:
    """Equal to the last bit, in every field of every part."""
    assert type(found) is type(expected)
    if dataclasses.is_dataclass(expected):
        for field in dataclasses.fields(expected):
            assert_identical(getattr(found, field.name), getattr(expected, field.name))
    elif isinstance(expected, tuple):
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            assert_identical(one, other)
    elif isinstance(expected, np.ndarray):
        assert (found.dtype, found.shape, found.tobytes()) == (
            expected.dtype,
            expected.shape,
            expected.tobytes(),
        )
    else:
        assert found == expected


def any_floats(rng: np.random.Generator, *shape: int) -> np.ndarray:
    """Numbers up to 1e100 of any bit pattern: any exponent, subnormal numbers, both zeros."""
    bits = rng.integers(0, 2**64, shape, dtype=np.uint64)
    numbers = bits.view(np.float64)
    numbers[~(np.abs(numbers) <= 1e100)] = -0.0
    numbers[rng.random(shape) < 0.1] = -5e-324
    return numbers


def any_singles(rng: np.random.Generator, *shape: int) -> np.ndarray:
    """Numbers of any bit pattern of single precision."""
    bits = rng.integers(0, 2**32, shape, dtype=np.uint32)
    numbers = bits.view(np.float32)
    numbers[~np.isfinite(numbers)] = -0.0
    return numbers.astype(np.float64)


def any_element(seed: int) -> Superelement:
    rng = np.random.default_rng(seed)
    names = ["root", "tip", "Flansch außen", "面", "a b", "-1"][: rng.integers(0, 7)]
    interfaces = tuple(Interface(name, any_floats(rng, 3), bool(rng.integers(2))) for name in names)
    n_c = sum(interface.n_dofs for interface in interfaces)
    n_k, m, p = rng.integers(2, 9), rng.integers(1, 5), rng.integers(1, 6)
    modes = Modes(
        10.0 ** rng.uniform(-9.0, 9.0, m),
        np.abs(any_floats(rng, m)) % 1.0,
        rng.normal(size=(n_c, m)),
        h_min=float(rng.integers(2) * rng.random()),
    )
    h, scheme = float(rng.uniform(1e-9, 1.0)), GeneralizedAlpha(float(rng.random()))
    kernel = sample_kernel(modes, h, scheme, int(n_k) - 1)
    cells = rng.integers(-1, p, (rng.integers(0, 4), 3))
    stress = any_singles(rng, p, 6, m) if rng.integers(2) else None
    return Superelement(
        name=f"Körper {seed}/2",
        mass=float(10.0 ** rng.uniform(-99.0, 99.0)),
        J_rot=np.diag(rng.uniform(1.0, 2.0, 3)),
        center=any_floats(rng, 3),
        interfaces=interfaces,
        kernel=replace(
            kernel,
            error=float(rng.random()),
            band=float(rng.uniform(1e-9, 1e9)) if seed % 2 else None,
        ),
        modes=modes if seed % 3 else None,
        compliance=modes.compliance,
        accelerance=modes.accelerance,
        recovery=Recovery(any_floats(rng, p, 3), cells, any_singles(rng, p, 3, m), stress)
        if seed % 3 == 1
        else None,
        provenance=Provenance(
            body="# größer als ein Attribut\n" * int(rng.integers(0, 9999)),
            mesh="",
            mesh_sha256="0f" * 32,
            method="modal",
            tolerance=float(rng.random()),
            versions={f"package {k}": f"{k}.0" for k in range(rng.integers(0, 12))},
            timings={f"stage {k}": float(rng.random()) for k in range(rng.integers(0, 12))},
        ),
    )


@pytest.fixture
def path(tmp_path):
    return tmp_path / "body.h5"


@pytest.mark.parametrize("seed", range(30))
def test_every_field_comes_back_to_the_last_bit(seed, path):
    element = any_element(seed)
    write(path, element)
    assert_identical(read(path), element)


def rotating(seed: int, level: int = 1) -> Superelement:
    """One with modes, and the second order of its motion."""
    element = any_element(3 * seed + 1)
    rotation = any_rotation(seed, element.modes, element.J_rot, level)
    return replace(element, rotation=rotation)


@pytest.mark.parametrize("level", [1, 2])
@pytest.mark.parametrize("seed", range(5))
def test_the_second_order_comes_back_to_the_last_bit(seed, level, path):
    element = rotating(seed, level)
    write(path, element)
    assert_identical(read(path), element)


@pytest.mark.parametrize("version", [1, 2])
def test_what_earlier_versions_did_not_have_is_passed_over(version, path):
    element = rotating(0)
    write(path, element)
    with h5py.File(path, "r+") as file:
        file.attrs["version"] = version
        if version == 1:
            file.move("static/accelerance", "static/mobility")
    assert_identical(read(path), replace(element, rotation=None))


@pytest.mark.parametrize("seed", range(3))
def test_files_of_version_1_are_read(seed, path):
    """They have the accelerance as "mobility", and all else as version 2 has it."""
    element = any_element(seed)
    write(path, element)
    with h5py.File(path, "r+") as file:
        file.attrs["version"] = 1
        file.move("static/accelerance", "static/mobility")
    assert_identical(read(path), element)


def test_a_recovery_is_kept_to_single_precision_and_read_only_if_wanted(path):
    element = any_element(4)
    rng = np.random.default_rng(0)
    p, _, m = element.recovery.phi.shape
    fine = replace(
        element.recovery, phi=rng.normal(size=(p, 3, m)), stress=1e12 * rng.normal(size=(p, 6, m))
    )
    write(path, replace(element, recovery=fine))
    for name in ("phi", "stress"):
        np.testing.assert_allclose(
            getattr(read(path).recovery, name), getattr(fine, name), rtol=2.0**-24
        )
    assert_identical(read(path, recovery=False), replace(element, recovery=None))


def large_surface(element: Superelement) -> Superelement:
    """One whose fields take some chunks, and whose last chunk is not full."""
    rng = np.random.default_rng(0)
    m = element.recovery.phi.shape[2]
    p = 2 * CHUNK_BYTES // (12 * m) + 1

    def singles(k: int) -> np.ndarray:
        return rng.normal(size=(p, k, m)).astype(np.float32).astype(float)

    cells = rng.integers(-1, p, (p, 6))
    nodes = rng.permutation(p) + 1
    recovery = Recovery(rng.normal(size=(p, 3)), cells, singles(3), singles(6), singles(3), nodes)
    outline = Outline(rng.normal(size=(p, 3)), np.maximum(cells, 0))
    return replace(element, recovery=recovery, outline=outline)


def test_large_fields_are_compressed_without_loss(path):
    element = large_surface(any_element(4))
    write(path, element)
    assert_identical(read(path), element)
    with h5py.File(path) as file:
        for name in ("phi", "stress", "phi_rotation", "cells"):
            dataset = file["recovery"][name]
            assert (dataset.compression, dataset.shuffle) == ("gzip", True)
            assert dataset.id.get_storage_size() < dataset.nbytes
            assert len(list(dataset.iter_chunks())) > 1
            assert np.prod(dataset.chunks) * dataset.dtype.itemsize <= CHUNK_BYTES
        assert file["outline/cells"].compression == "gzip"


def test_fields_that_are_not_compressed_are_read(path, monkeypatch):
    """As files have them that were written before."""
    element = large_surface(any_element(4))
    monkeypatch.setattr("duhamel.superelement.fields.CHUNK_BYTES", 1 << 40)
    write(path, element)
    with h5py.File(path) as file:
        assert file["recovery/stress"].chunks is None
    assert_identical(read(path), element)


def test_the_same_superelement_gives_the_same_file(make_element, tmp_path):
    for name in ("one.h5", "two.h5"):
        write(tmp_path / name, make_element())
    assert sha256(tmp_path / "one.h5") == sha256(tmp_path / "two.h5")


def test_groups_of_other_programs_are_passed_over(make_element, path):
    element = make_element()
    write(path, element)
    with h5py.File(path, "r+") as file:
        file["load_patterns/gravity"] = np.full(3, np.nan)
        file["kernel/velocity"] = np.zeros(7)
        file.attrs["colour"] = "red"
        file["interfaces"].attrs["colour"] = 3
    assert_identical(read(path), element)


def test_files_that_know_no_band_and_no_finest_step_are_exact(make_element, path):
    """As all were before either was written."""
    element = make_element()
    write(path, element)
    with h5py.File(path, "r+") as file:
        del file["modes"].attrs["h_min"]
        assert "band" not in file["kernel"].attrs
    assert_identical(read(path), element)


def test_text_of_fixed_length_and_other_number_types_are_read(make_element, path):
    """What other tools write: fixed-length text, the version as a float, big-endian and 32-bit
    integer data.
    """
    element = make_element()
    write(path, element)
    with h5py.File(path, "r+") as file:
        for name in ("format", "units", "name"):
            file.attrs[name] = np.bytes_(file.attrs[name])
        file.attrs["version"] = 2.0
        for name, dtype in (
            ("interfaces/name", "S9"),
            ("interfaces/row", "i4"),
            ("kernel/g", ">f8"),
        ):
            data = np.array(
                file[name].asstr()[()] if name.endswith("name") else file[name][()], dtype=dtype
            )
            del file[name]
            file[name] = data
    assert_identical(read(path), element)


def test_units_stand_at_every_dimensional_dataset(make_element, path):
    write(path, make_element())
    without = []
    with h5py.File(path) as file:
        file.visititems(
            lambda name, item: (
                without.append(name)
                if isinstance(item, h5py.Dataset) and "units" not in item.attrs
                else None
            )
        )
    assert without == [
        "interfaces/name",
        "interfaces/rotations",
        "interfaces/row",
        "recovery/cells",
    ]


# What write leaves behind


def unwritable(element: Superelement) -> Superelement:
    """HDF5 text holds no NUL, and the provenance comes last: the write fails when all else is in
    the file.
    """
    return replace(element, provenance=Provenance(mesh_sha256="\0"))


def test_a_failed_write_leaves_no_file(make_element, path):
    with pytest.raises(ValueError, match="NULL"):
        write(path, unwritable(make_element()))
    assert os.listdir(path.parent) == []


def test_a_failed_write_leaves_the_older_file_as_it_was(make_element, path):
    write(path, make_element())
    before = path.read_bytes()
    with pytest.raises(ValueError, match="NULL"):
        write(path, unwritable(make_element(1)))
    assert os.listdir(path.parent) == [path.name]
    assert path.read_bytes() == before


def test_a_full_disk_leaves_no_file_and_one_error(make_element, path):
    """A file size limit stands for the full disk; it holds for a whole process, hence one of its
    own.
    """
    source = path.with_name("source.h5")
    write(source, make_element(m=40))
    program = (
        "import resource, signal, sys\n"
        "from duhamel.superelement import SuperelementError, read, write\n"
        "element = read(sys.argv[1])\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))\n"
        "try:\n"
        "    write(sys.argv[2], element)\n"
        "except SuperelementError as error:\n"
        "    print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, source, path], capture_output=True, text=True, check=True
    )
    assert done.stdout == f"{path}: cannot be written: File too large\n"
    assert os.listdir(path.parent) == [source.name]


def test_writing_makes_a_file_that_others_may_read(make_element, path):
    """The temporary file is private; the umask, not that, decides who reads the result."""
    path.with_name("plain").touch()
    write(path, make_element())
    assert path.stat().st_mode == path.with_name("plain").stat().st_mode


def test_a_missing_folder_is_named(make_element, path):
    target = path.parent / "none" / "body.h5"
    with pytest.raises(SuperelementError, match=rf"{target}: no folder {target.parent}"):
        write(target, make_element())


def test_a_folder_in_the_place_of_the_file_is_refused(make_element, path):
    path.mkdir()
    with pytest.raises(SuperelementError, match=rf"{path}: cannot be written: not a regular file"):
        write(path, make_element())
    assert os.listdir(path.parent) == [path.name]


# What read refuses


def without(name):
    def change(file):
        del file[name]

    return change


def with_group(name):
    def change(file):
        del file[name]
        file.create_group(name)

    return change


def with_dataset(name, value):
    def change(file):
        del file[name]
        file[name] = value

    return change


def with_entry(name, index, value):
    def change(file):
        file[name][index] = value

    return change


def with_attribute(group, name, value):
    def change(file):
        file[group].attrs[name] = value

    return change


def without_attribute(group, name):
    def change(file):
        del file[group].attrs[name]

    return change


FAULTS = {
    "other format": (
        with_attribute("/", "format", "vtk"),
        "expected a superelement, found an HDF5 file of another program: duhamel preprocess writes",
    ),
    "no format": (without_attribute("/", "format"), "found an HDF5 file of another program"),
    "version 8": (
        with_attribute("/", "version", 8),
        "attribute 'version': expected 1 or 2 or 3 or 4 or 5 or 6 or 7, found 8$",
    ),
    "version 1 with the dataset of version 2": (
        with_attribute("/", "version", 1),
        "dataset 'static/mobility' is missing",
    ),
    "version list": (
        with_attribute("/", "version", [1, 2]),
        r"attribute 'version': expected 1 or 2 or 3 or 4 or 5 or 6 or 7, found array\(\[1, 2\]\)",
    ),
    "other units": (
        with_attribute("/", "units", "mm"),
        "attribute 'units': expected 'SI', found 'mm'",
    ),
    "name number": (with_attribute("/", "name", 3), r"attribute 'name': expected text, found .*3"),
    "no name": (with_attribute("/", "name", ""), "name: expected one line of text, found ''"),
    "no mass": (without("rigid/mass"), "dataset 'rigid/mass' is missing"),
    "mass list": (
        with_dataset("rigid/mass", [1.0, 2.0]),
        r"rigid/mass: expected shape \(\), found \(2,\)",
    ),
    "mass text": (
        with_dataset("rigid/mass", "heavy"),
        r"rigid/mass: expected numbers of shape \(\), found others.*heavy",
    ),
    "mass NaN": (
        with_dataset("rigid/mass", np.nan),
        "rigid/mass: expected finite numbers, found nan",
    ),
    "mass negative": (
        with_dataset("rigid/mass", -1.0),
        "mass: expected a positive number, found -1.0",
    ),
    "no rigid group": (without("rigid"), "dataset 'rigid/mass' is missing"),
    "J_rot": (
        with_entry("rigid/J_rot", (0, 0), -1.0),
        "J_rot: expected positive principal inertias, found",
    ),
    "J_rot skew": (with_entry("rigid/J_rot", (0, 1), 9.0), "J_rot: expected a symmetric matrix"),
    "center": (
        with_dataset("rigid/center", [0.0, 0.0]),
        r"center: expected shape \(3,\), found \(2,\)",
    ),
    "center of mass at the origin": (
        with_dataset("rigid/center", np.zeros(3)),
        "rigid, interfaces: expected the numbers whose digest is in the file",
    ),
    "interfaces at the center of mass": (
        with_dataset("interfaces/X", np.zeros((2, 3))),
        "rigid, interfaces: expected the numbers whose digest is in the file",
    ),
    "interface numbers": (
        with_dataset("interfaces/name", [1, 2]),
        "interfaces/name: expected text of shape",
    ),
    "interface twice": (
        with_dataset("interfaces/name", ["a", "a"]),
        r"interfaces: expected different names, found \['a', 'a'\]",
    ),
    "interface X": (
        with_dataset("interfaces/X", np.zeros((3, 3))),
        r"interfaces/X: expected shape \(2, 3\), found \(3, 3\)",
    ),
    "interface X NaN": (
        with_entry("interfaces/X", (1, 2), np.nan),
        r"interfaces/X: .* found nan at index \(1, 2\)",
    ),
    "rotations": (
        with_dataset("interfaces/rotations", [1, 2]),
        r"interfaces/rotations: expected true or false, found \[1.0, 2.0\]",
    ),
    "row": (
        with_dataset("interfaces/row", [0, 3]),
        r"interfaces/row: expected \[0, 6\], found \[0.0, 3.0\]",
    ),
    "row shape": (
        with_dataset("interfaces/row", [0, 6, 9]),
        r"interfaces/row: expected shape \(2,\), found \(3,\)",
    ),
    "no kernel": (without("kernel"), "group 'kernel' is missing"),
    "no g": (without("kernel/g"), "dataset 'kernel/g' is missing"),
    "g is a group": (with_group("kernel/g"), "dataset 'kernel/g' is missing"),
    "g shape": (
        with_dataset("kernel/g", np.zeros((8, 6, 6))),
        r"kernel/g: expected shape \(n_k, 9, 9\), found \(8, 6, 6\)",
    ),
    "g NaN": (
        with_entry("kernel/g", (3, 2, 1), np.nan),
        r"kernel/g: expected finite numbers, found nan at index \(3, 2, 1\)",
    ),
    "g skew": (
        with_entry("kernel/g", (3, 2, 1), 1.0),
        r"kernel: g: expected a symmetric matrix, found entries \(1, 2\) and \(2, 1\)",
    ),
    "g complex": (
        with_dataset("kernel/g", np.zeros((8, 9, 9), complex)),
        "kernel/g: expected real numbers",
    ),
    "g_initial": (
        with_entry("kernel/g_initial", (0, 0, 8), np.inf),
        r"kernel/g_initial: .* found inf at index \(0, 0, 8\)",
    ),
    "no step": (without_attribute("kernel", "h"), "attribute 'h' of group 'kernel' is missing"),
    "step text": (
        with_attribute("kernel", "h", "fast"),
        "attribute 'h' of group 'kernel': expected numbers",
    ),
    "step zero": (
        with_attribute("kernel", "h", 0.0),
        "kernel: h: expected a positive number, found 0.0",
    ),
    "rho_inf": (
        with_attribute("kernel", "rho_inf", 1.5),
        r"kernel: rho_inf must lie in \[0, 1\], got 1.5",
    ),
    "error NaN": (
        with_attribute("kernel", "error", np.nan),
        "attribute 'error' of group 'kernel': expected finite",
    ),
    "no omega": (without("modes/omega"), "dataset 'modes/omega' is missing"),
    "omega": (
        with_entry("modes/omega", 0, -2.0),
        "modes: omega: expected positive frequencies, found -2.0 rad/s",
    ),
    "zeta": (with_entry("modes/zeta", 0, -2.0), "modes: zeta: expected ratios >= 0, found -2.0"),
    "phi columns": (
        with_dataset("modes/phi", np.zeros((9, 5))),
        r"modes/phi: expected shape \(9, 4\), found \(9, 5\)",
    ),
    "phi rows": (
        with_dataset("modes/phi", np.zeros((8, 4))),
        r"modes/phi: expected shape \(9, 4\), found \(8, 4\)",
    ),
    "compliance": (
        with_dataset("static/compliance", np.eye(6)),
        r"compliance: expected shape \(9, 9\), found \(6, 6\)",
    ),
    "compliance skew": (
        with_entry("static/compliance", (0, 1), 9.0),
        "compliance: expected a symmetric matrix",
    ),
    "no accelerance": (without("static/accelerance"), "dataset 'static/accelerance' is missing"),
    "recovery phi": (
        with_dataset("recovery/phi", np.zeros((5, 3, 2))),
        r"recovery/stress: expected shape \(5, 6, 2\)",
    ),
    "recovery cells": (
        with_entry("recovery/cells", (0, 0), 5),
        "recovery: cells: expected point indices from -1 to 4, found -1 to 5",
    ),
    "no provenance": (without("provenance"), "group 'provenance' is missing"),
    "no versions": (without("provenance/versions"), "group 'versions' is missing"),
    "no method": (
        without_attribute("provenance", "method"),
        "attribute 'method' of group 'provenance' is missing",
    ),
    "timing": (
        with_attribute("provenance/timings", "modes", "long"),
        "attribute 'modes' of group 'provenance/timings': expected numbers",
    ),
}


def removed_from(name, rows):
    def change(file):
        kept = file[name][()][rows:]
        del file[name]
        file[name] = kept

    return change


FAULTS_OF_ROTATION = {
    "one switch": (
        without("rotation"),
        "group 'rotation' is missing, although there is modes/phi_inertia$",
    ),
    "no phi_inertia": (without("modes/phi_inertia"), "dataset 'modes/phi_inertia' is missing"),
    "no modes": (without("modes"), "dataset 'modes/phi_inertia' is missing"),
    "no T": (without("rotation/T"), "dataset 'rotation/T' is missing"),
    "form": (
        with_attribute("rotation", "form", "K0"),
        "attribute 'form' of group 'rotation': expected 'KM', found 'K0'",
    ),
    "n_soft": (
        with_attribute("rotation", "n_soft", 1),
        r"rotation/T: expected a row for each of n_low .*, found 5 with n_low = 1, n_soft = 1",
    ),
    "n_low": (
        with_attribute("rotation", "n_low", 1.5),
        "attribute 'n_low' of group 'rotation': expected a whole number, found 1.5",
    ),
    "n_low negative": (
        with_attribute("rotation", "n_low", -1),
        "rotation: n_low: expected 0 to 5, found -1",
    ),
    "A_inertia": (
        removed_from("rotation/A_inertia", 1),
        r"rotation/A_inertia: expected shape \(6, 5, 5\), found \(5, 5, 5\)",
    ),
    "skew": (
        with_entry("rotation/A_interface", (0, 0, 1), 9.0),
        "rotation: A_interface: expected symmetry",
    ),
    "kappa": (with_entry("rotation/kappa", 0, np.nan), "rotation/kappa: expected finite numbers"),
    "cubic alone": (without("rotation/quartic"), "rotation: expected both or none of cubic and q"),
    "T": (
        with_entry("rotation/T", (4, 0), 0.5),
        "rotation/T: expected projections by mass that give the shapes back, found a difference",
    ),
    "too much inertia": (
        with_entry("modes/phi_inertia", (0, 0), 9e9),
        "modes/phi_inertia: expected changes of inertia that the mass of the body allows",
    ),
    "cubic": (
        with_entry("rotation/cubic", (0, 1, 2), 99.0),
        "rotation/cubic: expected the same numbers in any order of the indices",
    ),
    "cubic too large": (
        with_entry("rotation/cubic", (0, 0, 0), 1e20),
        "rotation/quartic: expected no negative strain energy along a coordinate",
    ),
    "quartic": (
        with_entry("rotation/quartic", (1, 1, 1, 1), -1.0),
        "rotation/quartic: expected no negative strain energy along a coordinate",
    ),
}


def test_shapes_are_compared_before_names_are_read(make_element, path, monkeypatch):
    """A damaged file may have a million names, which take half a minute to read."""
    write(path, make_element())
    with h5py.File(path, "r+") as file:
        del file["interfaces"]
        file["interfaces/name"] = ["a"] * 50
        file["interfaces/X"] = np.zeros((50, 3))
        file["interfaces/rotations"] = [True] * 50
        file["interfaces/row"] = 6 * np.arange(50)
    monkeypatch.setattr("duhamel.superelement.file.texts", None)
    with pytest.raises(
        SuperelementError, match=r"static/compliance: expected shape \(300, 300\), found \(9, 9\)"
    ):
        read(path)


@pytest.mark.parametrize("fault", FAULTS_OF_ROTATION)
def test_each_fault_of_the_second_order_is_one_error(fault, make_element, path):
    change, message = FAULTS_OF_ROTATION[fault]
    element = make_element()
    rotation = any_rotation(0, element.modes, element.J_rot, level=2)
    write(path, replace(element, rotation=rotation))
    with h5py.File(path, "r+") as file:
        change(file)
    with pytest.raises(SuperelementError, match=message) as caught:
        read(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("fault", FAULTS)
def test_each_fault_is_one_error_that_names_file_and_place(fault, make_element, path):
    change, message = FAULTS[fault]
    write(path, make_element())
    with h5py.File(path, "r+") as file:
        change(file)
    with pytest.raises(SuperelementError, match=message) as caught:
        read(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


def test_a_missing_file_is_named(path):
    with pytest.raises(SuperelementError, match=rf"{path}: no such file"):
        read(path)


def test_a_file_that_is_not_hdf5_is_named(path):
    path.write_text("name = 'beam'\n")
    with pytest.raises(SuperelementError, match=rf"{path}: not a readable HDF5 file"):
        read(path)


@pytest.mark.parametrize("part", [0.1, 0.5, 0.9])
def test_a_file_cut_short_is_refused(part, make_element, path):
    write(path, make_element())
    os.truncate(path, int(part * path.stat().st_size))
    with pytest.raises(SuperelementError, match=rf"{path}: not a readable HDF5 file"):
        read(path)


@pytest.mark.parametrize("mark", [b"TREE", b"SNOD", b"HEAP", b"GCOL"])
def test_a_file_with_wrong_bytes_inside_is_refused(mark, make_element, path):
    """Each kind of structure that a file is made of has a mark, which is overwritten where it
    stands first.
    """
    write(path, make_element())
    path.write_bytes(path.read_bytes().replace(mark, b"\0\0\0\0"))
    with pytest.raises(SuperelementError, match=rf"{path}: "):
        read(path)
