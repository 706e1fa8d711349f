"""From elements, masses and interfaces to a structure with rigid-body modes."""
