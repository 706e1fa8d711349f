"""Impacts of surfaces: the parts that meet, and an explicit code of our own."""
