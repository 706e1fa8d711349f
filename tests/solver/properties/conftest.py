"""How many mechanisms the properties are tried on: the same few in every run, many new ones by
`pytest tests/solver/properties --hypothesis-profile many`, and for tools/mutate.py as soon as one
fails no smaller one.
"""

from hypothesis import HealthCheck, Phase, settings
from hypothesis.internal.conjecture import providers

# else the numbers in all sources that are loaded, also by other tests, would be among those drawn
providers.HypothesisProvider._local_constants = providers.Constants()

COMMON = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("few", max_examples=25, derandomize=True, database=None, **COMMON)
settings.register_profile(
    "faults", max_examples=8, derandomize=True, database=None, phases=[Phase.generate], **COMMON
)
settings.register_profile("many", max_examples=500, print_blob=True, **COMMON)
settings.load_profile("few")
