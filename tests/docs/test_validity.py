"""docs/validity.md lists every criterion with its limits."""

import math
import re
from pathlib import Path

from duhamel.cli.explain import ALL_CRITERIA
from duhamel.results.criteria import CRITERIA

PAGE = Path(__file__).parents[2] / "docs" / "validity.md"


def test_the_page_has_the_limits_of_every_criterion():
    rows = re.findall(
        r"^\| `(\w+)` \| [^|]* \| ([\d.e-]+)[^|]* \| ([\d.e-]+)", PAGE.read_text(), re.M
    )
    for name, own in ALL_CRITERIA.items():
        assert own.measures, name
    listed = {name: (float(good), float(limit)) for name, good, limit in rows}
    assert listed.keys() == CRITERIA.keys()
    for name, limits in listed.items():
        for limit, own in zip(limits, (CRITERIA[name].good, CRITERIA[name].limit), strict=True):
            assert math.isclose(limit, own, rel_tol=1e-3), name
