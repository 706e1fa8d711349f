"""How many mechanisms the properties are tried on: the same few in every run, or many new ones by
`pytest tests/solver/properties --hypothesis-profile many`.
"""

from hypothesis import HealthCheck, settings

COMMON = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("few", max_examples=25, derandomize=True, database=None, **COMMON)
settings.register_profile("many", max_examples=500, print_blob=True, **COMMON)
settings.load_profile("few")
