"""The client's clockwork on wired boards: time-outs, tries, silence, and who waits for what."""

from typing import Any

import pytest

from bus.protocol import Device, Opcode, Result, pack_heartbeat, pack_reply
from host.client import ClientError, Procedure
from host.telescope.state import BoardState, axis_state, board_states, stale_boards
from tests.host.telescope.wired import AXES, DEVICES, Wired, awake

RA, DEC = AXES


def run(made: Wired, procedure: Procedure, ticks: int = 400) -> Any:
    """Its value, and the ticks that it took."""
    for count in range(ticks):
        try:
            next(procedure)
        except StopIteration as end:
            return end.value, count
        made.tick()
    raise AssertionError("it does not end")


def test_a_wait_is_of_ticks() -> None:
    made = Wired()
    assert run(made, made.client.wait(0.0))[1] == 0
    assert run(made, made.client.wait(0.05))[1] == 1
    assert run(made, made.client.wait(1.0))[1] == 20
    assert run(made, made.client.wait(1.01))[1] == 21


def test_a_condition_is_waited_for_until_its_time() -> None:
    made = Wired()
    assert run(made, made.client.until("it", lambda: True, 0.0))[1] == 0
    begin = made.client.now_s
    assert run(made, made.client.until("it", lambda: made.client.now_s > begin + 0.49, 0.5))[1] == 10
    with pytest.raises(ClientError, match=r"^it: not within 0\.5 s$"):
        run(made, made.client.until("it", lambda: False, 0.5))
    assert made.client.now_s == pytest.approx(begin + 1.0)


def test_a_command_is_sent_three_times_200_milliseconds_apart() -> None:
    made = Wired()
    made.silent = {RA}
    procedure = made.client.ask(RA, Opcode.POWER, 1)
    times = []
    with pytest.raises(ClientError, match=r"^AXIS_RA: POWER 1: no answer after 3 tries$"):
        for _ in range(100):
            next(procedure)
            made.tick()
            times += [made.client.now_s] * len(made.since())
    assert times == pytest.approx([0.05, 0.25, 0.45]) and made.client.now_s == pytest.approx(0.65)
    assert [each for each in made.said("error") if "POWER" in each] == [
        "POWER 1: no answer, try 2", "POWER 1: no answer, try 3", "POWER 1: no answer after 3 tries",
    ]  # fmt: skip
    assert made.said("command") == ["POWER 1: no answer"]


def test_commands_of_a_board_go_one_by_one_and_the_next_follows_a_lost_one_at_once() -> None:
    made = Wired()
    made.silent = {RA}
    first, second = made.client.ask(RA, Opcode.POWER, 1), made.client.ask(RA, Opcode.POWER, 0)
    next(first)
    next(second)
    made.tick(12)
    assert {each[2] for each in made.since()} == {1}
    made.silent = set()
    made.tick()
    assert made.since() == [(RA, Opcode.POWER, 0)]
    with pytest.raises(StopIteration):
        next(second)
    with pytest.raises(ClientError):
        next(first)


def test_what_would_move_is_given_up_and_what_was_asked_is_not() -> None:
    made = Wired()
    made.silent = {RA}
    asked = [made.client.ask(RA, *each) for each in (
        (Opcode.PING,), (Opcode.GET_PARAMETER, 1), (Opcode.SET_PARAMETER, 1, 2),
        (Opcode.SET_RATE, 5), (Opcode.STOP,),
    )]  # fmt: skip
    for each in asked:
        next(each)
    made.client.forget(RA)
    made.client.forget(DEC)
    for each in asked[3:]:
        with pytest.raises(ClientError, match="given up"):
            next(each)
    made.silent = set()
    made.tick(5)
    assert [each[1] for each in made.since()] == [Opcode.PING, Opcode.GET_PARAMETER, Opcode.SET_PARAMETER]


def test_a_stop_passes_what_moves_nothing() -> None:
    made = Wired()
    for opcode, more in (
        (Opcode.SET_RATE, (5,)),
        (Opcode.PING, ()),
        (Opcode.GET_PARAMETER, (1,)),
        (Opcode.STOP, ()),
    ):
        next(made.client.ask(RA, opcode, *more))
    made.tick(6)
    assert [each[1] for each in made.since()] == [
        Opcode.SET_RATE,
        Opcode.STOP,
        Opcode.PING,
        Opcode.GET_PARAMETER,
    ]


def test_a_refusal_is_told_with_its_reason() -> None:
    made = Wired()
    result = Result(1)
    made.results[Opcode.POWER] = (int(result), 7)
    words = result.name.lower()
    with pytest.raises(ClientError, match=f"AXIS_RA: POWER 1 was refused: {words.replace('_', ' ')}"):
        run(made, made.client.ask(RA, Opcode.POWER, 1))
    assert made.said("command") == [f"POWER 1: {words} 7"] and f"POWER 1: {words}" in made.said("error")
    made.results[Opcode.POWER] = (0, 7)
    reply, _ = run(made, made.client.ask(RA, Opcode.POWER, 1))
    assert (reply.value, reply.result, reply.device) == (7, 0, RA)
    assert made.said("command")[-1] == "POWER 1: ok 7"


def test_an_answer_nobody_waits_for_is_told() -> None:
    made = Wired()
    assert made.link.on_reply is not None
    made.link.on_reply(0, pack_reply(RA, Opcode.STOP, 0, 0, 0))
    next(made.client.ask(RA, Opcode.STOP))
    made.link.on_reply(0, pack_reply(RA, Opcode.STOP, 0, 0, 0))
    late = f"late answer to opcode {int(Opcode.STOP):#04x}"
    assert made.said("status") == [late, late]
    assert {each.where for each in made.journal.entries} == {"device 0x11"}


def test_health_is_that_of_the_last_ping_and_gone_with_the_board() -> None:
    made = Wired()
    made.results[Opcode.PING] = (0, 5)
    run(made, made.client.ask(RA, Opcode.PING))
    assert made.client.health == {RA: 5}
    made.results[Opcode.PING] = (1, 8)
    with pytest.raises(ClientError):
        run(made, made.client.ask(RA, Opcode.PING))
    run(made, made.client.ask(RA, Opcode.STOP))
    assert made.client.health == {RA: 5}
    begin = made.client.now_s
    made.silent = {RA}
    made.tick(90)
    assert made.client.health == {}
    assert begin < made.client.now_s
    silent = [each for each in made.journal.entries if each.text.startswith("silent since")]
    assert len(silent) == 1 and silent[0].where == "AXIS_RA"


def quiet() -> Wired:
    made = Wired()
    made.frames = lambda: None  # type: ignore[method-assign]
    return made


def test_silence_is_told_after_three_heartbeats_and_a_half_and_its_end_too() -> None:
    made = quiet()
    made.link.heard_ns = dict.fromkeys(map(int, DEVICES), 10**15)
    made.link.heard_ns[int(RA)] = 1_000_000_000
    made.tick(89)
    assert made.said("error") == []
    made.tick(13)
    assert made.said("error") == ["silent since 1.0 s"]
    made.tick(30)
    made.link.heard_ns[int(RA)] = made.client.now_ns
    made.tick(12)
    made.tick(30)
    assert made.said("error") == ["silent since 1.0 s"] and made.said("status") == ["is back"]


def test_a_heartbeat_is_told_where_state_or_overruns_change() -> None:
    made = quiet()
    made.link.heard_ns = dict.fromkeys(map(int, DEVICES), 10**15)
    for state, overruns, tec in ((1, 0, 0), (1, 0, 9), (2, 0, 9), (2, 300, 9)):
        made.link.heartbeats[int(RA)] = pack_heartbeat(RA, state, 5, overruns, tec)
        made.tick(11)
    assert made.said("status") == [
        "state 1, overruns 0, tec 0", "state 2, overruns 0, tec 9", "state 2, overruns 300, tec 9",
    ]  # fmt: skip


def test_boards_are_shown_as_their_heartbeats_say() -> None:
    made = quiet()
    made.tick(200)
    made.link.heartbeats[int(RA)] = pack_heartbeat(RA, 3, 5, 300, 9)
    made.link.heartbeats[int(DEC)] = pack_heartbeat(DEC, 77, 5, 0, 0)
    now = made.client.now_ns
    made.link.heard_ns = {int(RA): now - 3_500_000_000, int(DEC): now - 3_500_000_001}
    ra, dec, *others = board_states(made.client)
    assert ra == BoardState(RA, True, 3, 300, 9, None)  # type: ignore[arg-type]
    assert dec == BoardState(DEC, False, None, 0, 0, None)
    assert {each[1:] for each in others} == {(False, None, 0, 0, None)}


@pytest.mark.parametrize(("device", "period_ms"), [(RA, 10), (Device.POSITION_DEC, 5), (Device.FOCUS, 50)])
def test_a_measurement_is_old_after_five_of_its_periods_and_a_tick(device: Device, period_ms: int) -> None:
    made = quiet()
    made.client.now_ns = 10_000_000_000
    made.link.measured_ns = {int(each): made.client.now_ns for each in DEVICES}
    oldest = made.client.now_ns - (5 * period_ms + 50) * 1_000_000
    made.link.measured_ns[int(device)] = oldest
    assert stale_boards(made.client) == frozenset()
    made.link.measured_ns[int(device)] = oldest - 1
    assert stale_boards(made.client) == {device}
    del made.link.measured_ns[int(device)]
    assert stale_boards(made.client) == {device}


def test_an_axis_is_read_from_its_frames() -> None:
    """By hand: 1000 counts of 0.0114796″ in 5 ms; ADC counts of 6.1 mA; 41 of 4096 counts in 10 ms."""
    from bus.protocol import AxisMode, pack_motion, pack_position, pack_tach, pack_target

    made = quiet()
    bare = axis_state(made.client, "ra")
    assert bare == (
        None,
        0.0,
        AxisMode.OFF,
        False,
        False,
        False,
        False,
        0.0,
        0.0,
        (0.0, 0.0),
        (None, None),
        0.0,
        None,
    )
    link = made.link
    link.measured_ns[int(Device.POSITION_RA)] = 2_000_000_000
    link.measurements[int(Device.POSITION_RA)] = pack_position(Device.POSITION_RA, 0, 12345, 250, 0)
    link.measurements[int(Device.MOTOR_RA_B)] = pack_tach(Device.MOTOR_RA_B, 0, 0, 41)
    link.summaries[int(RA)] = pack_target(RA, 0, 0, -1000)
    for flags, expected in (
        (1, (True, False, False, False)), (2, (False, True, False, False)), (4, None), (8, None),
    ):  # fmt: skip
        link.measurements[int(RA)] = pack_motion(RA, 2 | flags << 4, 1000, -1500, (100, 200))
        found = axis_state(made.client, "ra")
        if expected is not None:
            assert sum(found[3:7]) == 1
    assert found.steps == 12345 and found.latched_s == pytest.approx(2.0 - 0.001)
    assert found.mode == AxisMode(2)
    assert found.rate_arcsec_s == pytest.approx(1000 * 1296000 / (4_608_000 * 24.5) / 0.005, rel=1e-6)
    assert found.effort == -0.5 and found.currents_a == pytest.approx((0.61, 1.22))
    assert found.motor_turns_s[0] is None and found.motor_turns_s[1] == pytest.approx(41 / 4096 / 0.01)
    assert found.to_go_arcsec == pytest.approx(-1000 * 1296000 / 2**29)
    link.measurements[int(RA)] = pack_motion(RA, 15, 0, 0, (0, 0))
    assert axis_state(made.client, "ra").mode is AxisMode.OFF


def test_health_of_every_board_and_parameters_are_asked_for() -> None:
    made = awake()
    made.silent = {Device.FOCUS}
    made.results[Opcode.PING] = (0, 2)
    made.client.health[Device.FOCUS] = 0  # type: ignore[assignment]
    found = made.ended(made.do(lambda t: t.boards.check()))
    assert found == dict.fromkeys(DEVICES[:4], 2) | {Device.FOCUS: None}
    assert Device.FOCUS not in made.client.health
    made.since()
    made.results[Opcode.GET_PARAMETER] = (0, 33)
    assert made.ended(made.do(lambda t: t.boards.get(RA, 2))) == 33
    assert made.ended(made.do(lambda t: t.boards.set(RA, 2, 34))) == 33
    assert made.since() == [
        (RA, Opcode.GET_PARAMETER, 2), (RA, Opcode.SET_PARAMETER, 2, 34), (RA, Opcode.GET_PARAMETER, 2),
    ]  # fmt: skip


def test_an_emergency_stop_reaches_axes_and_focus_and_a_closed_telescope_says_so() -> None:
    from host.telescope import Reason, Refused

    made = awake()
    made.telescope.drive.tracking = True
    future = made.telescope.call(lambda t: t.emergency_stop(), urgent=True)
    assert made.telescope.urgent
    made.tick()
    assert not made.telescope.urgent and future.result(0) is made.telescope.drive.job
    made.tick(4)
    told = made.since()
    assert {(RA, Opcode.STOP), (DEC, Opcode.STOP), (Device.FOCUS, Opcode.FOCUS_HOLD)} <= {*told}
    assert not made.telescope.drive.tracking
    assert "emergency stop: sent" in made.said("command")
    waiting = made.telescope.call(lambda t: t.drive.stop())
    made.telescope.close()
    for late in (waiting, made.telescope.call(lambda t: t.drive.stop())):
        with pytest.raises(Refused, match="the telescope is shut down") as found:
            late.result(0)
        assert found.value.reason is Reason.SILENT


def test_a_mistake_of_a_door_is_the_doors() -> None:
    made = Wired()
    future = made.telescope.call(lambda t: 1 // 0)
    gone = made.telescope.call(lambda t: t.drive.stop())
    gone.cancel()
    made.tick()
    with pytest.raises(ZeroDivisionError):
        future.result(0)
    assert made.telescope.drive.job is None
