"""Impulse responses of the interfaces, by modes, Krylov vectors or time steps."""
