"""Duhamel: impulse superelements from meshes, and flexible multibody dynamics on them.

Where to begin, on the command line:

    duhamel init beam my-project      # a commented project that runs; or solid, mechanism
    cd my-project
    duhamel preprocess arm.toml       # a mesh becomes a superelement, arm.h5
    duhamel run model.toml            # the motion, model-results.h5
    duhamel plot model-results.h5     # a picture of it, model-results.png
    duhamel --help                    # all commands; python -m duhamel is the same

and in Python:

    from duhamel import preprocess, solver

    arm = preprocess.build(preprocess.read_body("arm.toml"))   # a Superelement
    model = solver.read_model("model.toml")                    # a Model: bodies, joints, loads
    results = solver.simulate(model)                           # Results
    results.frame("arm.tip").u                                 # elastic displacement of the tip [m]

What is in which package:

    duhamel.preprocess     body files and meshes, to superelements
    duhamel.superelement   what a superelement holds; read, write, check
    duhamel.solver         model files; simulate, modes, frequency responses
    duhamel.results        motions, forces, energies and fields of a run; spectra, peaks
    duhamel.study          a model for many values of its parameters
    duhamel.view           pictures, films, reports

`help(duhamel.solver)` and so on tell more, after `import duhamel.solver`. This module imports none
of them.
"""

TYPE_CHECKING = False  # as type checkers know it, without `typing`, which takes ten milliseconds

if TYPE_CHECKING:
    __version__: str
else:

    def __getattr__(name: str) -> str:
        """The version, looked up when it is asked for."""
        if name == "__version__":
            from importlib.metadata import version

            return version("duhamel")
        raise AttributeError(f"module 'duhamel' has no attribute {name!r}")
