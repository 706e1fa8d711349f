"""Bodies given by matrices instead of a mesh."""
