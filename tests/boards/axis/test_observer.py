"""The observer: its sections as difference equations, when it drives, which coefficients it takes."""

import random

import pytest

from boards.axis.observer import Observer
from boards.axis.pi import IncrementalPi
from bus.protocol.scales import rate_q16

ONE, ANGLE = 1 << 28, 1 << 24
RAMP = 428
"""3 arcsec/s in a second: 85 634 Q16 counts a tick in 200 ticks."""
SLOWEST, FASTEST = 142_723, 713_614
"""5 and 25 arcsec/s, 0.43556 counts a tick each, Q16."""
HELD = (rate_q16(15.0), 0)
Section = tuple[float, float, float, float, float, float]
NOTHING: Section = (0.0,) * 6


def observer(*sections: Section, through: float = 0.0) -> Observer:
    """With these sections, the rest nothing: trace, determinant, two of the effort, two of the angle."""
    made = Observer()
    cells = [each for section in (*sections, *[NOTHING] * 4)[:4] for each in section]
    scales = [ONE, ONE, ONE, ONE, ANGLE, ANGLE] * 4
    made.coefficients[:] = [round(cell * scale) for cell, scale in zip(cells, scales, strict=True)]
    made.coefficients.append(round(through * ANGLE))
    return made


def driving(made: Observer, pi: IncrementalPi) -> None:
    """The axis stands for half a second."""
    for _ in range(100):
        made.aim(HELD, 0, 0)
    assert made.driving


HOLD: Section = (0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize(("sections", "sound"), [
    ((), False), ((HOLD,), True), ((NOTHING, NOTHING, NOTHING, HOLD), True),
    (((0.5, 0.0, 0.3, 0.2, 0.0, 0.0),), True), (((0.5, 0.0, 0.3, 0.19, 0.0, 0.0),), False),
    (((0.5, 0.0, 0.25, 0.0, 0.0, 0.0), (0.0, 0.5, 0.0, 0.75, 9.0, 9.0)), True),
    (((0.0, 0.0, 0.991, 0.0, 0.0, 0.0),), True), (((0.0, 0.0, 1.009, 0.0, 0.0, 0.0),), True),
    (((0.0, 0.0, 0.989, 0.0, 0.0, 0.0),), False), (((0.0, 0.0, 1.011, 0.0, 0.0, 0.0),), False),
    ((HOLD, (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)), False), ((HOLD, (-1.0, 0.0, 0.0, 0.0, 0.0, 0.0)), False),
    ((HOLD, (0.0, 1.0, 0.0, 0.0, 0.0, 0.0)), False), ((HOLD, (0.0, -1.0, 0.0, 0.0, 0.0, 0.0)), False),
    ((HOLD, NOTHING, NOTHING, (1.25, 0.25, 0.0, 0.0, 0.0, 0.0)), False),
    ((HOLD, NOTHING, NOTHING, (-1.25, 0.25, 0.0, 0.0, 0.0, 0.0)), False),
    ((HOLD, NOTHING, NOTHING, (1.24, 0.25, 0.0, 0.0, 0.0, 0.0)), True),
    ((HOLD, NOTHING, NOTHING, (-1.24, 0.25, 0.0, 0.0, 0.0, 0.0)), True),
])  # fmt: skip
def test_B1_only_stable_sections_that_keep_an_effort_are_switched_on(
    sections: tuple[Section, ...], sound: bool
) -> None:
    """Jury: |determinant| < 1, |trace| < 1 + determinant; the numerators over 1 - trace + determinant: 1."""
    made = observer(*sections)
    made.switch(1)
    assert made.on == sound
    made.switch(0)
    assert made.on == 0


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("rate", "inside"), [
    (0, False), (SLOWEST, False), (SLOWEST + 1, True), (FASTEST - 1, True), (FASTEST, False),
])  # fmt: skip
def test_B1_it_drives_from_5_to_25_arcsec_a_second_once_the_axis_stands(
    rate: int, inside: bool, sign: int
) -> None:
    made = observer(HOLD)
    steady = (sign * rate, 0)
    for velocity in (-1, 1, 0) * 33:
        assert made.aim(steady, 77, velocity) == (0 if inside else 77)
        assert not made.driving
    assert made.aim(steady, 77, 1) == 77
    assert made.driving is inside
    made.aim((0, 0), 77, 0)
    assert not made.driving


@pytest.mark.parametrize("velocity", [2, -2])
def test_B1_two_counts_are_no_standing(velocity: int) -> None:
    made = observer(HOLD)
    for _ in range(99):
        made.aim(HELD, 77, 0)
    made.aim(HELD, 77, velocity)
    for _ in range(99):
        assert made.aim(HELD, 77, 0) == 0
    assert made.aim(HELD, 77, 0) == 77
    assert made.aim(HELD, 77, velocity) == 77  # it drives, and the axis may move
    made.switch(1)
    assert made.on and not made.driving and made.aim(HELD, 77, 0) == 0


def test_B1_it_takes_over_without_a_bump_and_the_angle_owed_grows_with_the_ramp() -> None:
    """Rate k ramps at tick k; the axis stands, so k (k + 1) / 2 ramps are owed; HOLD adds each up: n (n + 1)
    (n + 2) / 6."""
    made, pi = observer(HOLD, through=-1.0), IncrementalPi(0, 0, 3000)
    pi.replace(500 << 16)
    made.step(pi, 0)
    driving(made, pi)
    for n in range(1, 11):
        made.aim(HELD, 0, 0)
        assert made.step(pi, 0) == pi.steps
        assert pi.effort_q16 == (500 << 16) + RAMP * n * (n + 1) * (n + 2) // 6


@pytest.mark.parametrize(("correction", "added"), [(16.0, 1.0), (-32.0, -2.0), (640.0, 4.0), (-640.0, -4.0)])
@pytest.mark.parametrize("ticks", [500, 1400])
def test_B1_the_rate_is_the_set_one_and_a_sixteenth_of_the_correction(
    correction: float, added: float, ticks: int
) -> None:
    """The ramp has it within seven seconds; 4 arcsec/s at most are added. The axis follows, then it stops."""
    made, pi = observer(through=1 / 64), IncrementalPi(0, 0, 3000)
    driving(made, pi)
    wanted, steady = rate_q16(15.0 + added), (HELD[0], rate_q16(correction))
    gone = 0
    for k in range(1, ticks + 1):
        made.aim(steady, 0, 0)
        before, gone = gone, gone + min(k * RAMP, wanted)
        made.step(pi, (gone >> 16) - (before >> 16))
    for k in range(ticks + 1, ticks + 4):
        effort = pi.effort_q16
        made.aim(steady, 0, 0)
        made.step(pi, 0)
        assert effort - pi.effort_q16 == pytest.approx(min(k * RAMP, wanted) / 64, abs=1.1)


@pytest.mark.parametrize("velocity", [880, -880])
def test_B1_twenty_arcsec_owed_end_it_and_nothing_is_owed_afterwards(velocity: int) -> None:
    """1742 counts of 87.111 an arcsec: two ticks of 880."""
    made, pi = observer(HOLD, through=-0.001), IncrementalPi(0, 0, 3000)
    driving(made, pi)
    made.step(pi, velocity)
    assert made.driving
    kept = pi.effort_q16
    made.step(pi, velocity)
    assert not made.driving and pi.effort_q16 == kept
    driving(made, pi)
    made.step(pi, 0)
    assert pi.effort_q16 - kept == pytest.approx(RAMP * 0.001, abs=2)


def test_B1_each_section_is_its_difference_equation_of_effort_and_angle() -> None:
    """y(k) = trace y(k-1) - determinant y(k-2) + of effort and angle one and two ticks ago."""
    sections: tuple[Section, ...] = (
        (1.5, 0.6, 0.03, 0.01, 0.4, -0.3), (-0.7, 0.2, 0.3, -0.2, 0.05, 0.6),
        (0.9, -0.05, 0.02, 0.05, -0.5, 0.1), (0.2, 0.1, 0.05, 0.04, 0.25, 0.35),
    )  # fmt: skip
    made, pi = observer(*sections, through=0.7), IncrementalPi(0, 0, 3000)
    draw = random.Random(3)
    efforts, angles, out = [0.0, 0.0], [0.0, 0.0], [[0.0, 0.0] for _ in sections]
    velocities = [draw.choice((-1, 0, 1)) for _ in range(20)]
    rate = owed = 0.0
    for k in range(120):
        drives = k >= 100
        effort = draw.randint(-100, 100) << 16
        if not drives:
            pi.replace(effort)
        made.aim(HELD if drives or k == 99 else (0, 0), 0, 0)
        velocity = velocities[k - 100] if drives else 0
        made.step(pi, velocity)
        for section, y in zip(sections, out, strict=True):
            trace, determinant, *gains = section
            inputs = (efforts[-1], efforts[-2], angles[-1], angles[-2])
            given = sum(gain * each for gain, each in zip(gains, inputs, strict=True))
            y.append(trace * y[-1] - determinant * y[-2] + given)
        if made.driving:
            rate += RAMP
            owed += velocity * 65536 - rate
            efforts.append(sum(y[-1] for y in out) + 0.7 * owed)
            assert pi.effort_q16 == pytest.approx(efforts[-1], abs=500)  # of 10^7
        else:
            efforts.append(float(effort))
        angles.append(owed)
    assert made.driving
