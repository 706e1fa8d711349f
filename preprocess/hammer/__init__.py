"""Hammer tests of a mesh: what a test of the part would measure, and what would come of it."""
