"""Models: mechanisms, settings of their simulation, and model files."""
