"""Meshes to superelements."""
