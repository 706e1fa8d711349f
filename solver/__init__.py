"""Superelements and a model to motion."""
