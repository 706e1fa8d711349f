"""Duhamel: impulse superelements from meshes, and flexible multibody dynamics on them.

Where to begin, in Python:

    import duhamel as du

    part = du.Part(mesh, du.Material(E=70e9, nu=0.33, rho=2700.0))   # a mesh in memory, or a file
    part.interface("root", du.plane(x=0.0))
    part.interface("tip", du.plane(x=1.0))
    bar = part.superelement(step=2e-5, duration=0.01)

    m = du.Mechanism(gravity=[0, 0, -9.81])
    rod = m.add(bar, name="rod")
    m.add(du.joints.Revolute(m.ground, rod["root"], axis="z", name="hinge"))
    m.add(du.loads.Force(rod["tip"], [0, 1, 0], du.signals.HalfSine(200.0, 1e-3)))
    run = m.simulate(0.01)
    run["hinge"].angle                                               # (n,) [rad]
    run.plot("hinge.angle", "rod.tip.elastic_displacement.y").save("bar.png")

and on the command line:

    duhamel init beam my-project      # a commented project that runs; or solid, mechanism
    cd my-project
    duhamel preprocess arm.toml       # a mesh becomes a superelement, arm.h5
    duhamel run model.toml            # the motion, model-results.h5
    duhamel plot model-results.h5     # a picture of it, model-results.png
    duhamel --help                    # all commands; python -m duhamel is the same

What is in which package:

    duhamel.preprocess     body files and meshes, to superelements
    duhamel.superelement   what a superelement holds; read, write, check
    duhamel.solver         model files; simulate, modes, frequency responses
    duhamel.results        motions, forces, energies and fields of a run; spectra, peaks
    duhamel.study          a model for many values of its parameters
    duhamel.view           pictures, films, reports

`help(duhamel.solver)` and so on tell more, after `import duhamel.solver`. Importing this module
loads none of them: its names are loaded when they are first used.
"""

TYPE_CHECKING = False  # as type checkers know it, without `typing`, which takes ten milliseconds

if TYPE_CHECKING:
    from duhamel import (
        contacts,
        couplers,
        joints,
        laws,
        loads,
        motions,
        motors,
        signals,
        springs,
        stops,
    )
    from duhamel.mechanism import Mechanism
    from duhamel.parts import Beam, Part
    from duhamel.preprocess.body.material import Material, Section
    from duhamel.runs import Run
    from duhamel.selections import box, cylinder, face, group, hole, node, plane, sphere
    from duhamel.solver.model.bodies import RigidBody
    from duhamel.solver.model.fmus import FMU
    from duhamel.study import Parameter
    from duhamel.superelement import Superelement

    __version__: str

_MODULES = (
    *("contacts", "couplers", "joints", "laws", "loads"),
    *("motions", "motors", "signals", "springs", "stops"),
)
_NAMES = {
    "FMU": "solver.model.fmus",
    "Beam": "parts",
    "Material": "preprocess.body.material",
    "Mechanism": "mechanism",
    "Parameter": "study.parameter",
    "Part": "parts",
    "RigidBody": "solver.model.bodies",
    "Run": "runs",
    "Section": "preprocess.body.material",
    "Superelement": "superelement",
    "box": "selections",
    "cylinder": "selections",
    "face": "selections",
    "group": "selections",
    "hole": "selections",
    "node": "selections",
    "plane": "selections",
    "sphere": "selections",
}
"""names by the modules that they come from"""

__all__ = [
    "FMU",
    "Beam",
    "Material",
    "Mechanism",
    "Parameter",
    "Part",
    "RigidBody",
    "Run",
    "Section",
    "Superelement",
    "box",
    "contacts",
    "couplers",
    "cylinder",
    "face",
    "group",
    "hole",
    "joints",
    "laws",
    "loads",
    "motions",
    "motors",
    "node",
    "plane",
    "signals",
    "sphere",
    "springs",
    "stops",
]


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


if not TYPE_CHECKING:

    def __getattr__(name: str) -> object:
        """What a name stands for, loaded when it is first asked for."""
        if name == "__version__":
            from importlib.metadata import version

            return version("duhamel")
        if name not in _NAMES and name not in _MODULES:
            raise AttributeError(f"module 'duhamel' has no attribute {name!r}")
        from importlib import import_module

        found = import_module(f"duhamel.{_NAMES.get(name, name)}")
        if name in _NAMES:
            found = getattr(found, name)
        globals()[name] = found
        return found
