"""From a model of names and objects to the flat arrays of a time step."""
