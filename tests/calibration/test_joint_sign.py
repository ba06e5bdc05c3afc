"""An effect whose size turns over beside another one is none."""

import numpy as np

from calibration.balances.candidate import Candidate
from calibration.decide.energy import signed
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from tests.calibration.test_statistics import regression


def test_a_size_that_physics_excludes_beside_the_others_goes() -> None:
    """The loss looks right alone, because it follows the load, and is negative beside it."""
    rng = np.random.default_rng(2)
    n = 8000
    load = np.abs(rng.standard_normal(n)) + 1.0
    loss = load + 0.5 * rng.standard_normal(n)
    y = 3.0 * load - 0.4 * loss + 0.3 * rng.standard_normal(n)
    both = [
        Candidate(name, "current", x[:, None], (("size", "1"),), sign=1)
        for name, x in (("backlash_loss", loss), ("supply_sag", load))
    ]
    p = regression(y, np.ones((n, 1)), 0.05)
    alone = [fit_with(p, p.base, c) for c in both]
    picks = [c for c in alone if c is not None]
    assert len(picks) == 2 and all(c.fit.beta[-1] > 0 for c in picks)
    assert [c.name for c in signed(Selection.of(p, picks)).candidates] == ["supply_sag"]
    assert len(signed(Selection.of(p, picks[1:])).chosen) == 1
