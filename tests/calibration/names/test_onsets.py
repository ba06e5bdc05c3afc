"""Steps and ramps of friction from one time on: where they are tried, and how each begins."""

import numpy as np
import pytest

from calibration.names.onsets import steps
from calibration.names.scene import Scene
from tests.calibration.names.made import back_and_forth, drive

X = back_and_forth()
SPAN_S = 19.99
FILES = np.repeat([0, 1], 1000)


def tried(s: Scene, lengths: tuple[float, ...] = (), **more: object) -> list:  # type: ignore[type-arg]
    return steps(s, "brake_drag", ("torque", "N"), lambda x: 2.0 * x, lengths, **more)  # type: ignore[arg-type]


def test_a_step_is_tried_all_along_the_log_but_for_its_ends() -> None:
    found = tried(drive(X))
    at = [c.fixed["start"][0] for c in found]
    assert at == pytest.approx(np.linspace(0.06, 0.94, 24) * SPAN_S)
    assert all(c.steps == (pytest.approx(SPAN_S / 72),) and c.domain == "time" for c in found)
    assert found[0].labels == (("torque", "N"),) and list(found[0].fixed) == ["start"]


@pytest.mark.parametrize(("rows", "late_s"), [(1, 0.02), (4, 0.08)])
def test_a_step_rises_over_two_fitted_rows(rows: int, late_s: float) -> None:
    s = drive(X, rows=np.arange(0, 2000, rows))
    shape = tried(s)[0].shape
    assert shape is not None
    t = s.view.clock
    assert shape(np.array([5.0]))[:, 0] == pytest.approx(2.0 * np.clip((t - 5.0) / late_s, 0.0, 1.0))
    for beyond, kept in ((-3.0, 0.04), (99.0, 0.96)):
        expected = 2.0 * np.clip((t - kept * SPAN_S) / late_s, 0.0, 1.0)
        assert shape(np.array([beyond]))[:, 0] == pytest.approx(expected)


def test_a_slow_change_may_have_begun_before_the_log() -> None:
    found = tried(drive(X), (0.3, 0.5))
    assert len(found) == 48
    starts = np.linspace(-0.4, 0.96, 24) * SPAN_S
    for part, some in ((0.3, found[:24]), (0.5, found[24:])):
        assert [c.fixed["start"][0] for c in some] == pytest.approx(starts)
        assert [c.fixed["duration"][0] for c in some] == pytest.approx(24 * [part * SPAN_S])
        assert some[0].steps == pytest.approx((SPAN_S / 72, 0.008 * 10 * part * SPAN_S))
    shape = found[0].shape
    assert shape is not None
    t = drive(X).view.clock
    assert shape(np.array([4.0, 6.0]))[:, 0] == pytest.approx(2.0 * np.clip((t - 4.0) / 6.0, 0.0, 1.0))
    short = tried(drive(X), (0.02,))[0]  # a tenth of the time or less moves by as much
    assert short.steps == pytest.approx((SPAN_S / 72, 0.008 * SPAN_S))


def test_what_is_not_sure_moves_further() -> None:
    (one, *_), (two, *_) = (tried(drive(X), (0.3,), surely=part) for part in (0.02, 0.1))
    assert one.steps == pytest.approx((0.02 * SPAN_S, 0.024 * SPAN_S))
    assert two.steps == pytest.approx((0.1 * SPAN_S, 0.1 * SPAN_S))


def test_of_several_files_it_also_begins_in_every_one() -> None:
    s = drive(X, files=FILES)
    both = tried(s)
    assert [next(iter(c.fixed)) for c in both] == ["start"] * 24 + ["start_in_run"] * 24
    in_run = both[24]
    assert in_run.fixed["start_in_run"][0] == pytest.approx(0.06 * 9.99)
    assert in_run.columns[:1000] == pytest.approx(in_run.columns[1000:])
    assert len(tried(s, in_every_run=False)) == 24
    assert len(tried(drive(X, files=FILES, in_order=True), in_every_run=False)) == 0
    slow = tried(s, (0.3, 0.5))
    assert len(slow) == 3 * 24  # in every file a length is not told from a short one
    last = slow[-24:]
    assert [c.fixed["start_in_run"][0] for c in last] == pytest.approx(np.linspace(0.04, 0.96, 24) * 9.99)
    assert [c.fixed["duration"][0] for c in last] == pytest.approx(24 * [0.3 * 9.99])
