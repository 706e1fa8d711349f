"""Names of CAD files: a list that the command line needs without what reads them."""

UNITS_KNOWN = (".step", ".stp", ".iges", ".igs")
"""Those that say their unit of length."""
CAD_SUFFIXES = (*UNITS_KNOWN, ".brep")
