"""Modes of a part from its measured frequency responses, passive and reciprocal by construction."""
