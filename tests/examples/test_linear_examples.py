"""The example of linear analysis, which checks its own numbers."""

import numpy as np


def test_campbell(example, tmp_path):
    found = example("campbell").main(tmp_path)
    assert {path.name for path in tmp_path.glob("*.png")} == {"campbell-diagram.png"}
    np.testing.assert_allclose(found.critical, [139.1, 142.3, 554.6], atol=0.1)
