"""A part known by a simulated hammer test, and the part that it is welded to."""
