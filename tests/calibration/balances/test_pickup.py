"""A line of a fixed frequency in a force: where it is told, and what is none."""

from typing import Any

import numpy as np
import pytest

from calibration.balances import pickup
from calibration.balances.filters import Filter
from calibration.balances.pickup import pick_up
from calibration.balances.view import View
from calibration.inputs.declaration import Response
from tests.calibration.names.made import drive

ROWS, NOISE, LINE = 12_000, 0.05, 0.2
AT: np.ndarray = np.arange(ROWS)
FILES = np.repeat([0, 1], [7000, 5000])
MOTION: np.ndarray = 3 * np.sin(2 * np.pi * AT / 3000)
FORCE = Response("force", "N", gain=-2.0)


def view(
    line: np.ndarray | float = 0.2,
    cycles: float = LINE,
    noise: float = NOISE,
    sigma: float = 4.0,
    **more: Any,
) -> View:
    """A force of friction, noise, and a line of its own phase in either file; of -2 N per unit."""
    rng = np.random.default_rng(3)
    sine = line * np.cos(2 * np.pi * cycles * AT + 1.3 * FILES)
    speed = np.gradient(MOTION)
    force = np.tanh(100 * speed) + sine + noise * rng.standard_normal(ROWS)
    given = {
        "response": FORCE, "columns": {"force": force}, "files": FILES, "filter": Filter(sigma), **more
    }  # fmt: skip
    return drive(given.pop("motion", MOTION), **given).view


@pytest.mark.parametrize("cycles", [0.06, 0.2, 0.2004, 0.47])
def test_a_line_is_told_with_its_frequency_and_its_whole_amplitude(cycles: float) -> None:
    """Also what the filter takes of it: of the slowest, a third. A row lasts 0.01 s, the gain is -2."""
    found = pick_up(view(0.2, cycles))
    assert found is not None
    assert found[0] == pytest.approx(100 * cycles, abs=0.003)
    assert found[1] == pytest.approx(2 * 0.2, rel=0.04)


@pytest.mark.parametrize("cycles", [0.04, 0.49])
def test_what_the_filter_passes_or_alternates_from_row_to_row_is_no_pick_up(cycles: float) -> None:
    """Below 0.19 / 4 and above 0.48 cycles per row; a limit may be told."""
    assert pick_up(view(0.2, cycles)) is None
    assert pick_up(view(0.2, 0.3), top=0.25) is None and pick_up(view(0.2, 0.2), top=0.25) is not None


def test_noise_has_no_line_and_a_weak_one_changes_nothing() -> None:
    """Told from half of the noise on: an amplitude of 0.5 * 1.41 times it."""
    assert pick_up(view(0.0)) is None
    assert pick_up(view(0.6 * NOISE)) is None
    assert pick_up(view(0.95 * NOISE)) is not None


def test_without_a_column_a_filter_or_sound_rows_nothing_is_told() -> None:
    good = view()
    gone = view(response=Response("effort", "N"))
    divided = view(response=Response("force", "N", divide_by="load"))
    assert pick_up(good) is not None and pick_up(gone) is None and pick_up(divided) is None
    assert pick_up(view(sigma=0.0)) is None
    assert pick_up(view(ok=np.zeros(ROWS, dtype=bool))) is None


@pytest.mark.parametrize(("rows", "told"), [(2047, False), (2048, True)])
def test_a_file_of_2048_rows_has_a_spectrum(rows: int, told: bool) -> None:
    files = np.arange(ROWS) // rows
    assert (pick_up(view(0.2, files=files)) is not None) == told


def test_a_narrow_band_of_a_wide_filter_has_too_few_bins() -> None:
    """Of 8192 bins per cycle of rows less than 256 lie between the filter's edge and a limit of 0.07."""
    assert pick_up(view(0.2, 0.06), top=0.07) is None
    assert pick_up(view(0.2, 0.06), top=0.09) is not None


def test_rounding_leaves_a_line_of_half_a_step() -> None:
    found = view()
    found.quanta["force"] = 0.39
    assert pick_up(found) is not None
    found.quanta["force"] = 0.41
    assert pick_up(found) is None
    coarse = view(0.2, noise=0.3)
    coarse.columns["force"] = np.round(coarse.columns["force"])
    assert pick_up(coarse) is None


def test_at_one_speed_a_line_may_turn_with_the_drive() -> None:
    steady = np.cumsum(np.where(AT % 2000 < 1000, 1.0, -1.0) * (1 + 0.1 * np.sin(AT / 500)))
    assert pick_up(view(motion=steady)) is None
    varied = np.cumsum(np.where(AT % 2000 < 1000, 1.0, -1.0) * (1 + 0.5 * np.sin(AT / 500)))
    assert pick_up(view(motion=varied)) is not None


@pytest.mark.parametrize(("part", "told"), [(0.1, False), (0.6, True), (1.6, True), (6.0, False)])
def test_a_line_is_as_large_where_the_drive_is_slow(part: float, told: bool) -> None:
    """In the slow third by this factor."""
    speed = np.abs(np.gradient(MOTION))
    size = np.where(speed < np.quantile(speed, 1 / 3), part, 1.0)
    assert (pick_up(view(0.2 * size)) is not None) == told


def test_the_size_of_a_line_is_its_own_on_the_rows_that_count() -> None:
    e = 0.7 * np.cos(2 * np.pi * LINE * AT + 2.0 * FILES)
    spans = [(0, 7000), (7000, 12_000)]
    every = np.ones(ROWS, dtype=bool)
    assert pickup._sizes(e, spans, LINE, every) == pytest.approx(0.7, rel=1e-6)
    some = (AT // 10) % 3 == 0
    assert pickup._sizes(np.where(some, e, 99.0), spans, LINE, some) == pytest.approx(0.7, rel=1e-3)
    # by files: the root of the mean square, every row counts
    loud = np.where(FILES == 0, 1.0, 3.0) * e
    expected = 0.7 * np.sqrt((7 * 1 + 5 * 9) / 12)
    assert pickup._sizes(loud, spans, LINE, every) == pytest.approx(expected, rel=1e-6)
    assert pickup._sizes(loud, spans, LINE, FILES == 1) == pytest.approx(2.1, rel=1e-6)
    assert pickup._sizes(e, spans, LINE, ~every) == 0.0


def test_thirds_of_few_rows_say_nothing_of_speeds() -> None:
    e = 0.7 * np.cos(2 * np.pi * LINE * AT)
    for count, told in ((760, False), (772, True)):
        some = view(ok=np.arange(ROWS) % ROWS < 0)
        some.ok = np.isin(AT, np.linspace(0, ROWS - 1, count).astype(int))
        assert pickup._at_every_speed(some, e, [(0, ROWS)], LINE, 0.7) == told


def test_where_friction_turns_a_leap_does_not_count_for_the_size() -> None:
    leaps = view(0.2)
    rng = np.random.default_rng(8)
    at = rng.choice(ROWS, 25, replace=False)
    leaps.columns["force"][at] += 30.0
    found = pick_up(leaps)
    assert found is not None and found[1] == pytest.approx(0.4, rel=0.06)
