"""Runs with derivatives: the time step with dual numbers, and what it starts from.

`seeds` has the derivatives of arrays and start by parameters, `records` lays them beside the
values, `run` takes the steps, `rows` are results along a direction, and `scope` says what is
covered. docs/theory.md, Derivatives by dual numbers.
"""
