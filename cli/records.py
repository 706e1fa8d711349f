"""The records of commands in JSON, as docs/command-line.md describes them: units are in the names.

Numbers of results have the unit of their quantity, which stands beside them.
"""

from collections.abc import Iterator, Sequence
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from ..results import Peak, Results
from ..results.motion import BALANCED_ENERGIES
from ..results.validity import Validity
from ..solver import LinearModes, ModelCheck
from ..study import Optimum, Sensitivities
from ..superelement import Check, Modes, Superelement

Record = dict[str, Any]
SENSITIVITY_COLUMNS = ("output", "value", "parameter", "derivative", "error", "elasticity")


def superelement_record(file: Path, element: Superelement) -> Record:
    """The record of `duhamel info`."""
    kernel, source = element.kernel, element.provenance
    return {
        "file": str(file),
        "name": element.name,
        "mass_kg": element.mass,
        "center_of_mass_m": element.center,
        "inertia_kg_m2": element.J_rot,
        "interfaces": [
            {"name": each.name, "position_m": each.X, "dofs": each.n_dofs}
            for each in element.interfaces
        ],
        "surfaces": [
            {"name": each.name, "nodes": each.n, "area_m2": each.area}
            for each in (element.surfaces.patches if element.surfaces else ())
        ],
        "load_patterns": [
            {"name": each.name, "force_n": each.force, "moment_n_m": each.moment}
            for each in element.patterns
        ],
        "sensors": [
            {"name": each.name, "kind": each.kind, "position_m": each.X} for each in element.sensors
        ],
        "modes": None if element.modes is None else _modes_of_body(element.modes),
        "has_rotation": element.rotation is not None,
        "kernel": {
            "step_s": kernel.h,
            "length_s": kernel.length,
            "rho_inf": kernel.scheme.rho_inf,
            "relative_error": kernel.error,
            "band_hz": kernel.band,
        },
        "provenance": {
            "from": "test" if source.tested else "mesh",
            "source": source.mesh,
            "sha256": source.mesh_sha256,
            "method": source.method,
            "tolerance": source.tolerance,
            "versions": source.versions,
        },
    }


def _modes_of_body(modes: Modes) -> Record:
    order = np.argsort(modes.resonances)
    return {
        "frequencies_hz": modes.resonances[order] / (2.0 * np.pi),
        "damping_ratios": modes.zeta[order],
        "loss_factors": modes.loss_factors[order],
        "finest_step_s": modes.h_min or None,
    }


def checks_record(file: Path, name: str, checks: Sequence[Check], with_mesh: bool) -> Record:
    """The record of `duhamel check` of a superelement."""
    return {
        "file": str(file),
        "kind": "superelement",
        "name": name,
        "compared_with_mesh": with_mesh,
        "holds": all(one.holds for one in checks),
        "checks": [
            {
                "dataset": one.where,
                "expected": one.expected,
                "measure": one.measure,
                "found": one.found,
                "limit": one.limit,
                "holds": one.holds,
            }
            for one in checks
        ],
    }


def model_record(file: Path, checked: ModelCheck) -> Record:
    """The record of `duhamel check` of a model."""
    return {
        "file": str(file),
        "kind": "model",
        "bodies": checked.bodies,
        "flexible_bodies": checked.flexible,
        "constraints": checked.constraints,
        "degrees_of_freedom": checked.degrees_of_freedom,
        "redundant_constraints": checked.removed,
        "assembly_error_m": checked.assembly_error,
        "step_s": checked.step,
        "steps": checked.steps,
        "frequencies_hz": checked.frequencies,
        "free_frequencies_hz": checked.free_frequencies,
        "damping": [
            {"frequency_hz": one.frequency, "damping_ratio": one.ratio} for one in checked.damping
        ],
        "expected_time_s": checked.seconds,
        "expected_memory_bytes": checked.memory,
        "results_rows": checked.rows,
        "results_bytes": checked.results_size,
        "validity_of_first_steps": validity_records(checked.validity),
    }


def validity_records(validity: Validity) -> list[Record]:
    """Each check of a run or a linear analysis, the ones that are not known included."""
    return [
        {
            "criterion": check.criterion.name,
            "of": check.owner,
            "value": check.value,
            "unit": check.criterion.unit,
            "recommended": check.criterion.good,
            "limit": check.criterion.limit,
            "bounds_are": "lower" if check.criterion.least else "upper",
            "verdict": check.verdict,
        }
        for check in validity.checks
    ]


def run_record(model_file: Path, target: Path, results: Results, seconds: float) -> Record:
    """The record of `duhamel run`. seconds [s]: of the whole call."""
    solver = results.solver
    has_energy = "energy" in results.recorded
    return {
        "model_file": str(model_file),
        "results_file": str(target),
        "degrees_of_freedom": int(solver["degrees_of_freedom"]),
        "redundant_constraints": str(solver["removed"]),
        "steps": int(solver["steps"]),
        "rows": len(results.time),
        "end_s": float(results.time[-1]),
        "loop_time_s": float(solver["seconds"]),
        "total_time_s": seconds,
        "energy_at_end_j": (
            {name: float(getattr(results.energy, name)[-1]) for name in BALANCED_ENERGIES}
            if has_energy
            else None
        ),
        "energy_imbalance_j": float(results.energy.imbalance()[0]) if has_energy else None,
        "never_closed": results.never_closed,
        "within_limits": not results.validity.warnings,
        "validity": validity_records(results.validity),
    }


def peaks_record(results_file: Path, peaks: Sequence[Peak]) -> Record:
    """The record of `duhamel peaks`."""
    return {
        "results_file": str(results_file),
        "peaks": [
            {
                "quantity": peak.quantity,
                "unit": peak.unit,
                "largest": peak.largest,
                "largest_at": peak.at_largest,
                "smallest": peak.smallest,
                "smallest_at": peak.at_smallest,
                "at_unit": peak.base,
                "band_hz": peak.band if isfinite(peak.band) else None,
                "beyond_band": peak.is_beyond,
                "place": None
                if peak.place is None
                else {
                    "position_m": peak.place.position,
                    "in_mesh": peak.place.in_mesh,
                    "node": peak.place.node,
                },
            }
            for peak in peaks
        ],
    }


def modes_record(model_file: Path, spin: float, modes: LinearModes, validity: Validity) -> Record:
    """The record of `duhamel modes`."""
    return {
        "model_file": str(model_file),
        "spin_rad_per_s": spin,
        "modes": [
            {
                "number": k + 1,
                "frequency_hz": modes.frequencies[k],
                "damping_ratio": modes.ratios[k],
                "eigenvalue_real_rad_per_s": modes.values[k].real,
                "eigenvalue_imaginary_rad_per_s": modes.values[k].imag,
                "is_rigid": bool(modes.values[k] == 0.0),
                "is_unstable": bool(modes.unstable[k]),
            }
            for k in range(len(modes))
        ],
        "within_limits": not validity.warnings,
        "validity": validity_records(validity),
    }


def optimum_record(found: Optimum) -> Record:
    """The record of `duhamel optimize`."""
    return {
        "state": found.state,
        "converged": found.converged,
        "feasible": found.is_feasible,
        "violation": found.violation,
        "objective": {
            "goal": "maximize" if found.maximize else "minimize",
            "output": found.objective,
            "unit": found.unit,
            "start": found.start,
            "value": found.value,
        },
        "parameters": {
            one.name: {"start": one.start, "value": one.value, "at_bound": one.at_bound}
            for one in found.parameters
        },
        "constraints": [
            {
                "output": one.output,
                "unit": one.unit,
                "min": one.low,
                "max": one.high,
                "start": one.start,
                "value": one.value,
                "active": one.is_active,
                "multiplier": one.multiplier,
            }
            for one in found.constraints
        ],
        "outputs": {
            name: {"unit": found.units[name], "start": start, "value": value}
            for name, (start, value) in found.outputs.items()
        },
        "runs": found.runs,
        "failed": found.failed,
        "notes": list(found.notes),
    }


def sensitivity_record(found: Sensitivities) -> Record:
    """The record of `duhamel sensitivity`."""
    rows = [
        dict(zip(SENSITIVITY_COLUMNS, cells, strict=True)) for cells in sensitivity_cells(found)
    ]
    rows = [{**row, "unit": found.units[str(row["output"])]} for row in rows]
    return {"sensitivities": rows, "notes": list(found.notes)}


def sensitivity_cells(found: Sensitivities) -> Iterator[tuple[str | float, ...]]:
    """The derivatives by output and parameter, as `SENSITIVITY_COLUMNS` names them."""
    for i, name in enumerate(found.outputs):
        for j, parameter in enumerate(found.parameters):
            numbers = found.derivative[i, j], found.error[i, j], found.elasticity[i, j]
            yield name, float(found.value[i]), parameter, *map(float, numbers)
