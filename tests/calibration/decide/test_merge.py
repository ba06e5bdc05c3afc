"""Findings of all channels as one list: one effect, traces of another one, remainders."""

from itertools import permutations
from typing import Any

import pytest

from calibration.decide.merge import ANY_TRACE, EXPLAINED, SUPERFLUOUS, merge, traces
from calibration.finding import UNKNOWN, Finding, Parameter


def one(
    name: str, channel: str = "T", share: float = 0.5, domain: str = "axis_angle", **more: Any
) -> Finding:
    return Finding(name, channel, domain, share=share, **{"evidence": 50.0, **more})


def named(findings: list[Finding]) -> list[tuple[str, str]]:
    return [(f.name, f.channel) for f in merge(findings)]


def test_the_strongest_comes_first_by_share_then_by_evidence() -> None:
    """Evidence, which grows with the log, weighs a hundredth at most, of a thousand."""
    weak, strong = one("brake_drag", share=0.4), one("cable_wrap", share=0.5)
    assert merge([weak, strong]) == [strong, weak]
    sure = one("brake_drag", share=0.5, evidence=60.0)
    assert merge([strong, sure]) == merge([sure, strong]) == [sure, strong]
    surest, most = (one("brake_drag", share=0.5, evidence=1e9), one("cable_wrap", share=0.511))
    assert merge([surest, most]) == [most, surest]
    nearly = one("cable_wrap", share=0.509)
    assert merge([nearly, surest]) == [surest, nearly]


def test_names_that_are_gone_are_refused_as_traces_of_those_that_stay() -> None:
    drag, wrap, warm = one("brake_drag", share=0.4), one("cable_wrap"), one("friction_warmup", "K", share=0.1)
    why = "taken for a trace of brake_drag, cable_wrap"
    assert traces([warm, wrap, drag], [wrap, drag]) == [("K", "friction_warmup", why)]
    assert traces([wrap], [wrap]) == []


@pytest.mark.parametrize("settled", ["adc_gain", "magnet_weakening"])
def test_volts_settle_a_gain_that_the_torque_shows_too(settled: str) -> None:
    torque = one("adc_gain", equivalent=["brake_drag"])
    volts = one(settled, "E", 0.6, "motor_angle")
    assert merge([torque, volts]) == [volts]
    assert named([torque, one("supply_sag", "E", 0.6)]) == [("supply_sag", "E"), ("adc_gain", "T")]
    (alone,) = merge([torque])
    assert alone.equivalent == ["brake_drag", "magnet_weakening"]
    (sensors,) = merge([one("adc_gain", "K")])
    assert sensors.equivalent == ()
    (already,) = merge([one("adc_gain", equivalent=["magnet_weakening"])])
    assert already.equivalent == ["magnet_weakening"]
    assert named([one("brake_drag"), volts]) == [(settled, "E"), ("brake_drag", "T")]


def test_of_one_late_column_the_sensors_tell_most_whatever_its_share() -> None:
    late = {c: one("channel_delay", c, share, "clock") for c, share in (("S", 0.1), ("E", 0.9), ("T", 0.5))}
    for order in permutations(late.values()):
        assert merge(list(order)) == [late["S"]]
    assert merge([late["T"], late["E"]]) == [late["E"]]
    # any other effect is told by the channel that it takes most of
    quiet, loud = one("cable_wrap", "K", 0.3), one("cable_wrap", "T", 0.5)
    assert merge([quiet, loud]) == merge([loud, quiet]) == [loud]


def test_one_place_has_a_name_once_and_another_place_has_it_again() -> None:
    some = [one("gear_mesh", stage=s, share=x) for s, x in (("mesh1", 0.5), ("mesh2", 0.4), ("mesh1", 0.3))]
    assert merge(some) == some[:2]
    single = [one("gravity_imbalance", stage=s, share=x) for s, x in (("axis", 0.5), ("motor", 0.4))]
    assert merge(single) == single[:1]
    unknown = [one(UNKNOWN, share=x, domain=d) for d, x in (("time", 0.5), ("velocity", 0.4), ("time", 0.3))]
    assert merge(unknown) == unknown[:2]
    here = [one(UNKNOWN, share=x, domain="time", stage=s) for s, x in (("motor", 0.5), ("axis", 0.4))]
    assert merge(here) == here[:1]


def test_harmonics_of_one_channel_are_effects_of_their_own() -> None:
    first, second = (one("gear_mesh", stage="mesh1", harmonic=h, share=0.6 - h / 10) for h in (1, 2))
    assert merge([second, first]) == [first, second]
    assert merge([first, one("gear_mesh", "E", stage="mesh1", harmonic=2, share=0.4)]) == [first]
    once, again = (one("gravity_imbalance", stage="axis", harmonic=h, share=0.6 - h / 10) for h in (1, 2))
    assert merge([once, again]) == [once]


def eccentric(channel: str, harmonic: int, share: float, size: float) -> Finding:
    sizes = {"amplitude": Parameter(size, "arcsec" if channel == "K" else "N m")}
    return one("gear_eccentricity", channel, share, stage="shaft2", harmonic=harmonic, parameters=sizes)


@pytest.mark.parametrize("shares", [(0.5, 0.3), (0.3, 0.5)])
def test_a_twist_that_the_encoders_show_is_told_beside_its_torque(shares: tuple[float, float]) -> None:
    torque, twist = eccentric("T", 1, shares[0], 20.0), eccentric("K", 1, shares[1], 3.0)
    both = torque.having(kinematic=twist.parameters["amplitude"])
    assert merge([torque, twist]) == merge([twist, torque]) == [both]
    assert merge([twist]) == [twist] and merge([torque]) == [torque]
    without = one("gear_eccentricity", "K", shares[1], stage="shaft2", harmonic=1)
    assert merge([torque, without]) == [max(torque, without, key=lambda f: f.share)]
    volts = eccentric("E", 1, shares[1], 3.0)
    assert merge([torque, volts]) == [max(torque, volts, key=lambda f: f.share)]


def test_every_harmonic_of_a_torque_has_the_twist_of_its_own() -> None:
    torques = [eccentric("T", h, share, 20.0 * h) for h, share in ((1, 0.6), (2, 0.3))]
    twists = [eccentric("K", h, share, 3.0 * h) for h, share in ((1, 0.5), (2, 0.4))]
    both = [t.having(kinematic=k.parameters["amplitude"]) for t, k in zip(torques, twists, strict=True)]
    for order in permutations([*torques, *twists]):
        assert merge(list(order)) == both
    assert merge([torques[0], twists[1]]) == [torques[0]]  # the second has no torque


@pytest.mark.parametrize("shares", list(permutations((0.6, 0.5, 0.4))))
def test_beside_a_torque_the_twist_of_another_harmonic_is_not_told(shares: tuple[float, ...]) -> None:
    torque, own, other = (
        eccentric(c, h, x, 3.0) for (c, h), x in zip((("T", 2), ("K", 2), ("K", 1)), shares, strict=True)
    )
    assert merge([torque, own, other]) == [torque.having(kinematic=own.parameters["amplitude"])]


@pytest.mark.parametrize(("explained", "stays"), [(EXPLAINED, True), (EXPLAINED + 0.01, False), (0.9, False)])
def test_what_is_left_is_no_wind_where_effects_explain_most_of_the_torque(
    explained: float, stays: bool
) -> None:
    wind = one("wind_torque", share=0.3, domain="time")
    drag = one("brake_drag", share=explained)
    assert (wind in merge([drag, wind])) is stays and drag in merge([drag, wind])
    assert wind in merge([one("brake_drag", "K", share=explained), wind])  # sensors explain no torque
    assert merge([one("wind_torque", share=0.9, domain="time")])


def test_a_resonance_that_is_damped_away_is_none() -> None:
    for damping, stays in ((0.02, True), (50.0, False)):
        mode = one("structural_mode", parameters={"damping": Parameter(damping, "1")})
        assert bool(merge([mode])) is stays


def test_a_shadow_goes_whatever_its_size() -> None:
    """A damaged tooth is seen by the encoders as a gear of its stage."""
    tooth, gear = one("damaged_tooth", share=0.2), one("gear_mesh", "K", 0.9)
    assert merge([gear, tooth]) == [tooth]
    assert len(merge([one("gear_mesh", "E", 0.9), tooth])) == 2
    assert len(merge([one("play", "K", 0.9), tooth])) == 2


@pytest.mark.parametrize(("share", "gone"), [(ANY_TRACE, True), (ANY_TRACE + 0.01, False), (0.9, False)])
def test_in_another_channel_a_consequence_that_is_small_or_smaller_is_a_trace(
    share: float, gone: bool
) -> None:
    cause = one("backlash_loss", "E", 0.1)
    assert (merge([cause, one("brake_drag", "T", share)]) == [cause]) is gone
    larger = one("backlash_loss", "E", 0.8)
    assert merge([larger, one("brake_drag", "T", 0.8)]) == [larger]
    assert len(merge([larger, one("brake_drag", "T", 0.81)])) == 2
    elsewhere = one("backlash_loss", "K", 0.8)  # not the channel that it has consequences from
    assert len(merge([elsewhere, one("brake_drag", "T", 0.2)])) == 2


@pytest.mark.parametrize(("part", "gone"), [(SUPERFLUOUS, False), (0.9 * SUPERFLUOUS, True)])
def test_in_one_channel_a_consequence_is_a_trace_where_it_is_a_remainder(part: float, gone: bool) -> None:
    wrap = one("cable_wrap", share=0.8)
    warm = one("friction_warmup", share=0.8 * part, evidence=100.0)
    assert (warm not in merge([wrap, warm])) is gone and wrap in merge([wrap, warm])
    both = [one(f.name, "K", f.share) for f in (wrap, warm)]  # not the channel that it has consequences from
    assert len(merge(both)) == 2


def test_wind_beside_a_cause_is_its_trace_whatever_its_share() -> None:
    lost, wind = one("sample_loss", "S", 0.1, "clock"), one("wind_torque", share=0.9, domain="time")
    assert merge([lost, wind]) == [lost]
    shape = one(UNKNOWN, share=0.1, domain="velocity")
    assert merge([wind, shape]) == [shape]


@pytest.mark.parametrize(
    ("share", "evidence", "stays"),
    [
        (0.9, 24.0, False),
        (0.9, 25.0, True),
        (1.0, 24.0, True),
        (0.0, 24.0, True),  # a number beyond its tolerance takes nothing off
        (1e-3, 24.0, False),
    ],
)
def test_a_weak_effect_of_the_torque_beside_a_much_stronger_one_is_its_remainder(
    share: float, evidence: float, stays: bool
) -> None:
    strong = one("brake_drag", share=0.5)
    weak = one("play", share=share * SUPERFLUOUS * 0.5, evidence=evidence)
    assert (weak in merge([strong, weak])) is stays and strong in merge([strong, weak])
    assert len(merge([strong, one("play", "K", 0.01, evidence=1.0)])) == 2
    assert len(merge([one("brake_drag", "K", 0.5), one("play", share=0.01, evidence=1.0)])) == 2
