"""Make the reference of the code from its docstrings: `python tools/make_reference.py build/docs`.

Needs pdoc, and the packages as `duhamel`. All modules are in it, those behind `__init__` too.
"""

import os
import sys
import warnings
from importlib import import_module
from pathlib import Path

from import_order import PACKAGES, modules


def module_names() -> list[str]:
    """Every module of every package, from the bottom up."""
    names = []
    for package in PACKAGES:
        for module in modules(package):
            parts = module[:-1] if module[-1] == "__init__" else module
            names.append(".".join(("duhamel", *parts)))
    return names


def show_entries_as_functions() -> None:
    """Compiled entries are objects that Python calls: readers want the functions that they call."""
    from duhamel.solver.compiler.marks import ENTRIES

    for entry in ENTRIES.values():
        function = entry.function
        setattr(sys.modules[function.__module__], function.__name__, function)


def main(folder: Path) -> None:
    # pdoc refuses processes that modules start on import; platform asks for the processor in one
    os.environ.setdefault("PDOC_ALLOW_EXEC", "1")
    import pdoc

    names = module_names()
    for name in names:
        import_module(name)
    show_entries_as_functions()
    pdoc.render.configure(docformat="markdown", footer_text="Duhamel", show_source=True)
    with warnings.catch_warnings():
        # a package without __all__ brings its modules along
        warnings.filterwarnings("ignore", "The module specification")
        pdoc.pdoc(*names, output_directory=folder)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
