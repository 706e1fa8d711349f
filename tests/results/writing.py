"""Results written without a solver: contents of any size, and an output full of random numbers."""

from types import SimpleNamespace

import numpy as np
from duhamel.results.batches import Batch, Energies, EventRows
from duhamel.results.contents import SuperelementFile, lay_out
from duhamel.results.dimensions import Axis
from duhamel.results.motion import EVENT_QUANTITIES, output_fields

NOTES = {"h": 0.1, "steps": 10, "finished": False, "assembly_error_at": ""}
START = Energies(2.0, 6.0)


def make_contents(
    bodies=2,
    joints=(2, 0, 3),
    springs=1,
    coordinates=2,
    flexible=1,
    contacts=2,
    stops=2,
    motors=2,
    couplers=1,
    fmus=1,
    second_order=3,
    sensors=3,
    surfaces=1,
    selects=lambda group: True,
):
    """Bodies with a frame each, joints with as many constraints as given, springs of one
    component; coordinates and friction belong to the last joint.
    """
    constraints = [f"j{j}.{i}" for j, n in enumerate(joints) for i in range(1, n + 1)]
    n, n_j = len(constraints), len(joints)
    axes = {
        "body": [f"b{i}" for i in range(bodies)],
        "frame": [f"b{i}.tip" for i in range(bodies)],
        "second_order_coordinate": [f"b0.{i}" for i in range(second_order)],
        "joint": [f"j{j}" for j in range(n_j)],
        "spring": [f"s{i}" for i in range(springs)],
        "joint_constraint": constraints,
        "spring_component": [f"s{i}.1" for i in range(springs)],
        "joint_coordinate": [f"j{n_j - 1}.angle_{i}" for i in range(coordinates if joints else 0)],
        "contact": [f"k{k}" for k in range(contacts)],
        "surface_contact": [f"c{k}" for k in range(surfaces)],
        "surface_row": [f"c{k}.{i}" for k in range(surfaces) for i in (1, 3, 4)],
        "surface_node": [f"c{k}.{i}" for k in range(surfaces) for i in (1, 2, 3, 4)],
        "mode": [f"b0.{i}" for i in range(1, 1 + 5 * surfaces)],
        "surface_load": [f"b0.{i}" for i in range(1, 1 + 4 * surfaces)],
        "stop": [f"e{k}" for k in range(stops)],
        "motor": [f"m{k}" for k in range(motors)],
        "coupler": [f"g{k}" for k in range(couplers)],
        "fmu": [f"f{k}" for k in range(fmus)],
        "fmu_input": [f"f{k}.{name}" for k in range(fmus) for name in ("tau", "u")],
        "joint_with_friction": [f"j{n_j - 1}.friction"] if joints else [],
        "pattern": [f"b0.p{i}" for i in range(min(sensors, 2))],
        "sensor": [f"b0.g{i}" for i in range(sensors)],
        "sensor_channel": [f"b0.g{i}.strain" for i in range(sensors)],
        "event_owner": [f"k{k}" for k in range(contacts)] + [f"e{k}" for k in range(stops)],
    }
    first = {
        "frame": 1,
        "spring": n_j,
        "spring_component": n,
        "coupler": n + springs,
        "stop": contacts,
    }
    axes = {
        name: Axis(
            tuple(entries),
            tuple(i % 2 == 1 for i in range(len(entries))),
            tuple(first.get(name, 0) + i for i in range(len(entries))),
        )
        for name, entries in axes.items()
    }
    files = {f"b{i}": SuperelementFile(f"/nowhere/{i}.h5", f"{i:064x}") for i in range(flexible)}
    return lay_out(axes, files, selects)


def make_output(contents, n, seed=0):
    """n rows of all fields, wide enough for the contents."""
    rng = np.random.default_rng(seed)

    def end(name):
        rows = contents.axes[name].rows if name in contents.axes else ()
        return max(rows, default=-1) + 1

    sizes = {
        "axis": 3,
        "quaternion": 4,
        "contact_axis": 3,
        "tangent_axis": 2,
        "contact": max(end("contact"), end("stop")),
        "surface_contact": end("surface_contact"),
        "surface_row": end("surface_row"),
        "surface_node": end("surface_node"),
        "mode": end("mode"),
        "surface_load": end("surface_load"),
        "motor": end("motor"),
        "fmu_input": end("fmu_input"),
        "joint_with_friction": end("joint_with_friction"),
        "body": end("body"),
        "second_order_coordinate": end("second_order_coordinate"),
        "frame": end("frame"),
        "coupling": max(end("joint"), end("spring")),
        "pattern": end("pattern"),
        "sensor_channel": end("sensor_channel"),
        "row": max(map(end, ("joint_constraint", "spring_component", "coupler"))),
        "joint_coordinate": end("joint_coordinate"),
    }
    fields = {}
    for name, (dimensions, integer) in output_fields().items():
        shape = (n, *(sizes[dimension] for dimension in dimensions[1:]))
        fields[name] = rng.integers(1, 9, shape) if integer else rng.normal(size=shape)
    return SimpleNamespace(**fields)


def make_events(contents, m, seed=0):
    """m events of all owners."""
    rng = np.random.default_rng(seed)
    values = rng.normal(size=(m, len(EVENT_QUANTITIES)))
    values[:, [quantity.integer for quantity in EVENT_QUANTITIES]] = 3.0
    return EventRows(rng.integers(0, len(contents.axes["event_owner"]), m), values)


def batch(output, first, n, events=None):
    """The steps from `first` on, in the first rows of an output of their own."""
    rows = {name: array[first : first + n] for name, array in vars(output).items()}
    events = EventRows.none() if events is None else events
    return Batch(np.arange(first, first + n), 0.1, SimpleNamespace(**rows), START, events)
