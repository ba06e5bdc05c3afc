"""The auxiliary encoder on the host (P10, H5): which turn, which moment, what the estimate is worth."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.protocol import Device
from host.auxiliary import (
    ABSOLUTE_ARCSEC,
    AUXILIARY_ARCSEC,
    AUXILIARY_STEP_ARCSEC,
    BOARDS,
    TURN_ARCSEC,
    auxiliary,
    combine,
    unwrapped,
)
from host.client import Client
from host.link import HidLink
from host.logs.journal import Journal
from host.logs.sensors import readings
from host.sky.mount import STEP_ARCSEC
from host.telescope.state import axis_state
from plant.model import load
from plant.plant import Plant
from scenarios.lab.network import build
from scenarios.lab.networks import NetworkConfig
from tests.host.console.test_parts import MOUNT

SECOND_NS = 1_000_000_000


@given(st.floats(0, 1_296_000), st.floats(-0.4, 0.4))
def test_P10_the_on_shaft_encoder_tells_the_turn(angle: float, error_turns: float) -> None:
    steps = math.floor(angle / AUXILIARY_STEP_ARCSEC) % 2**17
    found = unwrapped(steps, angle + error_turns * TURN_ARCSEC)
    assert found <= angle + 1e-6 < found + AUXILIARY_STEP_ARCSEC + 1e-3


def test_H5_the_stated_deviation_is_the_estimates_own_for_the_errors_it_is_stated_for() -> None:
    """Errors drawn as the sources state them: within ±1″, within ±15″/10.8, a step of 0.9155″."""
    rng = np.random.default_rng(11)
    truth = rng.uniform(0, 1_296_000, 40_000)
    shaft = truth + rng.uniform(-1, 1, truth.size)
    geared = truth + rng.uniform(-15 / 10.8, 15 / 10.8, truth.size)
    geared = (np.floor(geared / AUXILIARY_STEP_ARCSEC) + 0.5) * AUXILIARY_STEP_ARCSEC
    found = [combine(round(a / STEP_ARCSEC), float(b)) for a, b in zip(shaft, geared, strict=True)]
    errors = np.array([f.estimate_arcsec for f in found]) - truth
    assert errors.std() == pytest.approx(found[0].sigma_arcsec, rel=0.02)  # 40 000 draws: 0.35 %
    assert found[0].sigma_arcsec == pytest.approx((ABSOLUTE_ARCSEC**-2 + AUXILIARY_ARCSEC**-2) ** -0.5)
    assert errors.std() < min((shaft - truth).std(), (geared - truth).std())
    assert all(each.agree for each in found)


def test_H5_readings_that_cannot_both_be_right_are_not_averaged() -> None:
    found = combine(round(1000 / STEP_ARCSEC), 1020.0)
    assert not found.agree
    assert found.estimate_arcsec == pytest.approx(1000.0, abs=STEP_ARCSEC)
    assert combine(round(1000 / STEP_ARCSEC), 1020.0, 15.0).agree, "at slew 20″ are a matter of milliseconds"


@pytest.mark.parametrize("rate", [0.0, 15.0, 600.0])
def test_H5_on_the_final_network_both_encoders_agree_within_what_is_stated(rate: float) -> None:
    """At rest and under way; the emulated encoders have no errors, what is left is step and time."""
    start = {"ra": 1 << 28, "dec": 200_000_000}
    network = build(NetworkConfig(name="final"), Plant(load(), 3, start), 3)
    link = HidLink(network.hid.write)
    network.hid.to_host = link.receive
    client = Client(link, Journal(None))
    if rate:
        from bus.protocol import Opcode, pack_command
        from bus.protocol.scales import rate_q16

        for command in ((Opcode.POWER, 1), (Opcode.SET_RATE, rate_q16(rate))):
            link.queue(pack_command(Device.AXIS_RA, *command))
            link.flush(network.queue.now_ns)
            network.run_until(network.queue.now_ns + SECOND_NS // 10)
    network.run_until(3 * SECOND_NS)
    left, sigmas = [], []
    for _ in range(100):
        network.run_until(network.queue.now_ns + SECOND_NS // 50)
        state = axis_state(client, "ra")
        assert state.auxiliary is not None and state.steps is not None
        found = combine(state.steps, *state.auxiliary)
        assert found.agree and found.difference_arcsec is not None
        left.append(found.difference_arcsec)
        sigmas.append(state.auxiliary.sigma_arcsec)
    assert np.sqrt(np.mean(np.square(left))) < np.mean(sigmas)
    assert abs(np.mean(left)) < AUXILIARY_STEP_ARCSEC / 2 + 0.001 * rate + 0.1
    assert "ra_combined_sigma=" in readings(client, MOUNT)


def test_without_the_board_there_is_no_reading() -> None:
    link = HidLink(lambda _t, _report: None)
    assert auxiliary(link, "ra", 1000, 0.0, 0.0) is None
    link.measurements[BOARDS["ra"]] = bytes([0x23, 1, 0, 0, 0, 0, 0, 0])
    link.measured_ns[BOARDS["ra"]] = 0
    assert auxiliary(link, "ra", 1000, 0.0, 0.0) is None, "it says itself that it is ill"
