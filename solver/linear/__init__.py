"""Linear analysis of an assembled model about an equilibrium, at rest or in steady rotation."""
