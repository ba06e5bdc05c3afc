"""What log effects do to the rows of a packet: by their declared sizes, on samples made here."""

from typing import Any, NamedTuple

import numpy as np
import pytest

from host.logs.distort import chain, channel_delay, clock_jitter, log_wrap, sample_loss


class Sample(NamedTuple):
    effort: int = 0
    position: int = 0
    velocity: int = 0
    adc_a: int = 0
    adc_b: int = 0
    tach_a: int = 0
    tach_b: int = 0


def packet(count: int, **columns: Any) -> Any:
    return [(0.01 * k, Sample(**{n: int(x[k]) for n, x in columns.items()})) for k in range(count)]


def rng() -> np.random.Generator:
    return np.random.default_rng(3)


def test_whole_packets_are_lost_as_often_as_is_declared() -> None:
    distort = sample_loss(rng(), packet_loss=0.3, repeats=0.0)
    left = [distort(packet(4, effort=range(4))) for _ in range(2000)]
    assert {len(each) for each in left} == {0, 4}
    assert np.mean([not each for each in left]) == pytest.approx(0.3, abs=0.04)  # four sigma
    assert all(each == packet(4, effort=range(4)) for each in left if each)


def test_a_repeated_sample_is_the_one_before_at_its_own_time() -> None:
    distort = sample_loss(rng(), packet_loss=0.0, repeats=0.2)
    same = []
    for _ in range(400):
        rows = distort(packet(11, effort=range(11)))
        assert [t for t, _ in rows] == [0.01 * k for k in range(11)] and rows[0][1].effort == 0
        efforts = [sample.effort for _, sample in rows]
        for k in range(1, 11):
            assert efforts[k] in (k, efforts[k - 1])
            same.append(efforts[k] == efforts[k - 1])
    assert np.mean(same) == pytest.approx(0.2, abs=0.03)


def test_stamps_move_by_the_declared_deviation_and_samples_stay() -> None:
    distort = clock_jitter(rng(), deviation=0.002)
    given = packet(4000, effort=range(4000))
    rows = distort(given)
    off = np.array([t for t, _ in rows]) - 0.01 * np.arange(4000)
    assert off.std() == pytest.approx(0.002, rel=0.05) and abs(off.mean()) < 0.00013
    assert [sample for _, sample in rows] == [sample for _, sample in given]


@pytest.mark.parametrize(
    ("column", "names", "signed"),
    [
        (0, {"effort"}, True), (1, {"position"}, False), (2, {"velocity"}, True),
        (3, {"adc_a", "adc_b"}, False), (4, {"tach_a", "tach_b"}, True),
    ],
)  # fmt: skip
def test_a_column_keeps_its_bits(column: int, names: set[str], signed: bool) -> None:
    """Of four bits: 0 to 15, or -8 to 7. Wrapped by 16, or clipped to the ends."""
    values = range(-40, 40)
    low, high = (-8, 7) if signed else (0, 15)
    rows = packet(80, **dict.fromkeys(Sample._fields, values))
    for mode, expected in (
        (0.0, [(v - low) % 16 + low for v in values]),
        (1.0, [min(max(v, low), high) for v in values]),
    ):
        cut = log_wrap(rng(), column=float(column), bits=4.0, mode=mode)(rows)
        for name in Sample._fields:
            kept = [getattr(sample, name) for _, sample in cut]
            assert kept == (expected if name in names else list(values)), name
        assert [t for t, _ in cut] == [t for t, _ in rows]


@pytest.mark.parametrize("rows", [0, 1, 3])
def test_the_effort_is_the_one_in_force_so_long_before(rows: int) -> None:
    """Over the ends of packets; before there was any, the first."""
    distort = channel_delay(rng(), column=0.0, delay=0.01 * rows)
    given = packet(12, effort=range(100, 112), velocity=range(12))
    late = [row for k in (0, 4, 8) for row in distort(given[k : k + 4])]
    assert [sample.effort for _, sample in late] == [max(100, 100 + k - rows) for k in range(12)]
    assert [sample.velocity for _, sample in late] == list(range(12))
    between = channel_delay(rng(), column=0.0, delay=0.015)(given)
    assert [sample.effort for _, sample in between][2:] == [100 + k - 2 for k in range(2, 12)]


def test_one_after_the_other() -> None:
    clip = log_wrap(rng(), column=0.0, bits=4.0, mode=1.0)
    late = channel_delay(rng(), column=0.0, delay=0.01)
    both = chain([clip, late])
    assert both is not None and chain([]) is None
    assert [sample.effort for _, sample in both(packet(3, effort=[20, 3, -20]))] == [7, 7, 3]
