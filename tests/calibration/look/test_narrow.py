"""What the usual filter hides is looked for behind a narrower one."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from calibration.balances.view import View
from calibration.balances.width import MOST, NARROW, USUAL, told_by_noise
from calibration.decide.residual import Left
from calibration.finding import UNKNOWN, Finding
from calibration.inputs.logs import read_drive
from calibration.inputs.rigfile import load_rig
from calibration.look import response
from calibration.look.looked import Balance, Options
from tests.calibration.test_drives import FORCE, motion

LEFT = Left(times=9.0, part=0.9)


@pytest.mark.parametrize(("takes", "finer", "taken"), [
    (1.0, "play", "finer"), (1.1, "play", "usual"), (1.0, UNKNOWN, "usual"),
])  # fmt: skip
def test_a_narrower_filter_is_taken_where_it_alone_shows_a_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, takes: float, finer: str, taken: str
) -> None:
    """takes: times what is left behind the usual filter, that was there before."""
    (tmp_path / "rig.yaml").write_text(FORCE)
    t, x, u = motion()
    columns = np.column_stack([t, np.round(x, 3), u])
    np.savetxt(tmp_path / "d.csv", columns, delimiter=",", header="t,x,u", comments="")
    rig, seen, look = load_rig(tmp_path / "rig.yaml"), list[float](), response.look_at_forces

    def told(view: View, *more: Any) -> Balance:
        seen.append(view.wide)
        name, which = ((UNKNOWN, "usual"), (finer, "finer"))[len(seen) - 1]
        real = look(view, *more)
        before = takes * real.selection.held.after
        found = [Finding(name, "T", "time")]
        return replace(real, findings=found, before=before, missing=LEFT, remarks=[which])

    monkeypatch.setattr(response, "look_at_forces", told)
    options = Options(hold_out=[], out=tmp_path, plant=None, replay=False, tell=lambda _: None)
    found = response.look_at_response(read_drive([tmp_path / "d.csv"], rig), rig, options)
    assert found.balances[0].remarks == [taken]
    assert any("a narrower one is taken" in x for x in found.balances[0].notes) == (taken == "finer")
    assert seen[1:] == [] if takes > 1.0 else seen[1] < seen[0]


@pytest.mark.parametrize("limits", [USUAL, NARROW])
def test_a_filter_leaves_as_much_noise_in_the_acceleration_as_its_limits_say(limits: Any) -> None:
    """Of white noise, seen through the filter that is told; one row in four narrower would leave more."""
    rng, noise = np.random.default_rng(8), 0.01
    x = 10.0 * np.sin(2 * np.pi * np.arange(40_000) / 600.0)
    file = np.zeros(len(x), dtype=np.int64)
    sigma = told_by_noise(x, file, noise, limits)
    assert limits.least <= sigma < MOST

    def part(width: float) -> float:
        both = (noise * rng.standard_normal(len(x)), x)
        luck, true = (gaussian_filter1d(np.diff(z, 2), width)[200:-200] for z in both)
        return float(np.std(luck) / np.std(true))

    assert part(sigma) < 1.05 * limits.noise < part(sigma / 1.3) * 1.1
