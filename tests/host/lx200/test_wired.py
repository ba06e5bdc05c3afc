"""The table of LX200 commands on wired boards, without a socket: answers, bounds and what is sent."""

import asyncio
import math
from typing import Any

import pytest

from bus.protocol import Device, FocusFlag, Opcode, SpeedClass
from bus.protocol.scales import rate_q16
from host.lx200 import angles
from host.lx200.moving import MOVING, TAKING
from host.lx200.reading import READING
from host.lx200.session import ACK, Handbox, Parser, Session
from host.lx200.setting import SETTING
from host.sky.observed import sidereal_time_rad
from host.telescope import AsyncDesk, DriveRate
from tests.host.telescope.wired import AXES, CENTRE, Wired, awake

RA, DEC = AXES
SIDEREAL = 15.041067


def session(wired: Wired | None = None) -> tuple[Wired, Session]:
    made = wired or awake()
    made.tick(2)
    box = Handbox(made.observatory.clock, made.observatory.name)
    return made, Session(AsyncDesk(made.telescope), box, READING | MOVING, TAKING | SETTING, "test")


def ask(made: Wired, box: Session, command: str) -> str:
    """The answer, while the boards go on."""

    async def body() -> str:
        task = asyncio.ensure_future(box.answer(command))
        for _ in range(100):
            await asyncio.sleep(0)
            if task.done():
                break
            made.tick()
        return await task

    return asyncio.run(body())


@pytest.mark.parametrize(("command", "field", "value"), [
    ("Sr05:30:00", "target_ra_rad", 5.5 * math.pi / 12), ("Sr00:00:00", "target_ra_rad", 0.0),
    ("Sr24:00:00", "target_ra_rad", None), ("Sr-00:30:00", "target_ra_rad", None),
    ("Srx", "target_ra_rad", None),
    ("Sr23:59:59", "target_ra_rad", (24 - 1 / 3600) * math.pi / 12),
    ("Sd-30*30:00", "target_dec_rad", -math.radians(30.5)), ("Sd+90*00:00", "target_dec_rad", math.pi / 2),
    ("Sd-90*00:00", "target_dec_rad", -math.pi / 2), ("Sd+90*00:01", "target_dec_rad", None),
    ("Sd-90*00:01", "target_dec_rad", None), ("Sz360*00", "target_az_rad", 2 * math.pi),
    ("Sz000*00", "target_az_rad", 0.0), ("Sz360*01", "target_az_rad", None),
    ("Sz-00*01", "target_az_rad", None),
    ("Sa-90*00", "target_alt_rad", -math.pi / 2), ("Sa+90*00", "target_alt_rad", math.pi / 2),
    ("Sa+90*01", "target_alt_rad", None), ("Sa-90*01", "target_alt_rad", None),
])  # fmt: skip
def test_a_target_is_taken_within_its_bounds(command: str, field: str, value: float | None) -> None:
    made, box = session()
    assert ask(made, box, command) == ("0" if value is None else "1")
    found = getattr(box, field)
    assert found is None if value is None else found == pytest.approx(value)
    made.tick()
    assert any("not set" in each for each in made.said("error")) == (value is None)


@pytest.mark.parametrize(("command", "answer"), [
    ("Sg280*33", "1"), ("Sg-79*27", "1"), ("Sg-79*57", "1"), ("Sg-79*58", "0"), ("Sg281*04", "0"),
    ("Sg400*33", "0"), ("Sg360*00", "0"), ("Sg640*33", "0"), ("St+29*22", "1"), ("St+29*51", "1"),
    ("St+29*53", "0"),
    ("St+28*51", "0"),
    ("SG-05.5", "1"), ("SG+14.0", "1"), ("SG-14.0", "1"), ("SG+14.1", "0"), ("SG-14.1", "0"), ("SGx", "0"),
    ("SL12:00:00", "1"), ("SL25:00:00", "0"), ("SC13/01/26", "0"), ("ST56.3", "0"),
    ("ST62.1", "0"), ("STx", "0"),
    ("ST56.4", "1"), ("ST62.0", "1"), ("So30*", "1"), ("Sh5'", "1"), ("Swx", "0"), ("SMPlace", "1"),
])  # fmt: skip
def test_settings_are_answered_by_one_or_nought(command: str, answer: str) -> None:
    made, box = session()
    assert ask(made, box, command) == answer


def test_a_frequency_is_a_rate_in_proportion() -> None:
    made, box = session()
    ask(made, box, "ST60.0")
    assert made.telescope.drive.drift_arcsec_s == pytest.approx(((60.0 / 60.1 - 1) * SIDEREAL, 0.0))
    assert ask(made, box, "GT") == "60.0#"
    for letter, rate, hertz in (
        ("L", DriveRate.LUNAR, "57.9"), ("S", DriveRate.SOLAR, "60.0"), ("Q", DriveRate.SIDEREAL, "60.1"),
    ):  # fmt: skip
        assert ask(made, box, f"T{letter}") == ""
        assert made.telescope.drive.drive_rate is rate and ask(made, box, "GT") == f"{hertz}#"
        assert made.telescope.drive.drift_arcsec_s == (0.0, 0.0)


def test_clock_and_names_of_the_hand_box() -> None:
    """India is five hours and a half ahead; what is set runs on."""
    made, box = session()
    begin = made.client.now_s
    assert ask(made, box, "GL") == "19:30:00#" and ask(made, box, "GC") == "02/10/26#"
    assert ask(made, box, "GG") == "-05.5#" and ask(made, box, "Gc") == "24#"
    assert ask(made, box, "SL01:02:03") == "1" and ask(made, box, "SC03/04/27").startswith("1Updating")
    made.tick(40)
    assert ask(made, box, "GL") == "01:02:05#" and ask(made, box, "GC") == "03/04/27#"
    assert ask(made, box, "SC03/04/27") == "1Updating Planetary Data#" + " " * 30 + "#"
    assert made.client.now_s > begin
    names = ["Nainital", "Site 2", "Site 3", "Site 4"]
    for letter, name in zip("MNOP", names, strict=True):
        assert ask(made, box, f"G{letter}") == f"{name}#"
        ask(made, box, f"S{letter}{letter}" + "x" * 20)
        assert ask(made, box, f"G{letter}") == f"{letter}{'x' * 14}#"
    ask(made, box, "SG+03.0")
    assert ask(made, box, "GG") == "+03.0#"


def test_places_are_read_in_both_precisions() -> None:
    made, box = session()
    made.steps = [CENTRE, CENTRE]
    made.tick()
    about, t_s = made.observatory, made.client.now_s
    ra = sidereal_time_rad(about.site, about.clock, t_s)
    assert ask(made, box, "GR")[:5] == angles.hours(ra)[:5] and len(ask(made, box, "GR")) == 9
    assert ask(made, box, "GD") == "-00\xdf00:26#" or ask(made, box, "GD").startswith("-00\xdf00")
    assert ask(made, box, "GA") == "+60\xdf38'00#" and ask(made, box, "GZ") == "180\xdf00'00#"
    assert ask(made, box, "GS")[:8] == angles.hours(
        sidereal_time_rad(about.site, about.clock, made.client.now_s)
    )
    assert ask(made, box, "Gt") == "+29\xdf22#" and ask(made, box, "Gg") == "280\xdf33#"
    assert ask(made, box, "Gr") == "00:00:00#" and ask(made, box, "Gd") == "+00\xdf00:00#"
    assert ask(made, box, "U") == "" and box.box.precise is False
    assert ask(made, box, "GA") == "+60\xdf38#" and len(ask(made, box, "GR")) == 8
    assert Session(box.desk, box.box, {}, {}, "next").precise is False
    ask(made, box, "U")
    assert box.precise and ask(made, box, "GW") == "PN1#"
    assert ask(made, box, "GVP") == "schmidt#" and ask(made, box, ACK) == "P"


def test_a_slew_says_what_is_in_the_way() -> None:
    made, box = session()
    assert ask(made, box, "MS") == "2no target has been set#"
    ra = sidereal_time_rad(made.observatory.site, made.observatory.clock, made.client.now_s)
    ask(made, box, f"Sr{angles.hours(ra)}")
    assert ask(made, box, "MS") == "2no target has been set#"
    ask(made, box, "Sd-60*00:00")
    assert ask(made, box, "MS").startswith("1LX200 target is at altitude +00d")
    ask(made, box, "Sd+88*00:00")
    assert ask(made, box, "MS").startswith("2LX200 target is at declination +87d")
    ask(made, box, "Sd+20*00:00")
    assert ask(made, box, "D") == "#"
    assert ask(made, box, "MS") == "0" and made.telescope.drive.tracking
    assert ask(made, box, "D") == "\x7f#" and ask(made, box, "GW") == "PT1#"
    assert ask(made, box, "Q") == ""
    made.tick(10)
    assert ask(made, box, "D") == "#"


def test_the_ground_is_gone_to_once_it_is_set() -> None:
    made, box = session()
    assert ask(made, box, "MA") == "1"
    ask(made, box, "Sz180*00")
    assert ask(made, box, "MA") == "1"
    ask(made, box, "Sa+10*00")
    assert ask(made, box, "MA") == "1"
    ask(made, box, "Sa+50*00")
    assert ask(made, box, "MA") == "0"
    made.tick(8)
    goal = [each[2] for each in made.since() if each[1] == Opcode.MOVE_TO][:2]
    assert math.degrees(made.observatory.observed(*goal).altitude_rad) == pytest.approx(50.0, abs=1e-3)


def test_a_match_aligns_or_says_why_not() -> None:
    made, box = session()
    assert ask(made, box, "CM") == "not matched: no target has been set#"
    made.steps = [CENTRE, CENTRE]
    made.tick()
    ask(made, box, f"Sr{ask(made, box, 'GR')[:-1]}")
    ask(made, box, "Sd+00*10:00")
    assert ask(made, box, "CM") == "Coordinates     matched.        #"
    assert len(made.observatory.stars) == 1
    ask(made, box, "Sd+40*10:00")
    assert ask(made, box, "CM").startswith("not matched: the encoders say +")
    assert "\xb0" not in ask(made, box, "CM")


@pytest.mark.parametrize(
    ("way", "axis", "sign"), [("n", DEC, 1), ("s", DEC, -1), ("e", RA, -1), ("w", RA, 1)]
)
@pytest.mark.parametrize(("letter", "rate"), [("S", 7200.0), ("M", 600.0), ("C", 100.0), ("G", 15.0)])
def test_keys_move_at_the_speed_that_was_chosen(
    way: str, axis: Device, sign: int, letter: str, rate: float
) -> None:
    made, box = session()
    assert box.speed is SpeedClass.SLEW
    assert ask(made, box, f"R{letter}") == "" and ask(made, box, f"M{way}") == ""
    made.tick(6)
    assert rate_q16(sign * rate) in [each[2] for each in made.since() if each[0] == axis]
    other = {"n": "e", "s": "w", "e": "n", "w": "s"}[way]
    ask(made, box, f"Q{other}")
    assert made.telescope.paddle.held
    ask(made, box, f"Q{way}")
    assert not made.telescope.paddle.held


def test_pulses_are_in_milliseconds() -> None:
    made, box = session()
    ask(made, box, "AP")
    made.tick(60)
    told: list[Any] = []
    made.telescope.paddle.guider.told = told.append
    for command in ("Mgn2000", "Mge0500", "Mgn", "Mgnx", "Mgn-5", "Mgn\xb2"):
        assert ask(made, box, command) == ""
    assert [(each.axis, each.seconds) for each in told] == [(1, 2.0), (0, 0.5)]
    assert ask(made, box, "AL") == "" and not made.telescope.drive.tracking
    assert ask(made, box, "Mgn100") == ""
    made.tick()
    assert "guiding needs a telescope that tracks" in made.said("error")


def test_focus_keys_are_slow_or_quick() -> None:
    made, box = session()
    made.focus(0, int(FocusFlag.REFERENCED))
    for command, told in (
        ("F+", (Opcode.FOCUS_MOVE_TO, -800)), ("F-", (Opcode.FOCUS_MOVE_TO, 800)),
        ("FQ", (Opcode.FOCUS_HOLD,)),
        ("FS", None), ("F+", (Opcode.FOCUS_STEP, -1)), ("FF", None), ("F-", (Opcode.FOCUS_MOVE_TO, 800)),
    ):  # fmt: skip
        made.since()
        assert ask(made, box, command) == ""
        made.tick(2)
        found = made.since()
        assert found[:1] == ([] if told is None else [(Device.FOCUS, *told)]) or told is None, command


def test_parking_waking_and_what_nobody_knows() -> None:
    parked = Wired()
    made, box = session(parked)
    assert made.telescope.drive.parked
    ask(made, box, "hW")
    made.tick(60)
    assert made.telescope.drive.tracking and not made.telescope.drive.parked
    ask(made, box, "hP")
    made.tick(30)
    assert made.telescope.drive.parked and not made.telescope.drive.tracking
    for known in ("AA", "TM", "W5", "L123"):
        assert ask(made, box, known) == ""
    assert box.unknown == 0
    assert ask(made, box, "ZZ") == "" and box.unknown == 1


def test_commands_come_whole_however_they_were_cut() -> None:
    parser = Parser()
    assert parser.feed(b":G") == [] and parser.feed(b"R#x\x06:GD#") == ["GR", ACK, "GD"]
    assert parser.feed(b":S" + b"x" * 39 + b"#") == ["S" + "x" * 39]
    assert parser.feed(b":S" + b"x" * 40 + b"#:GR#") == ["GR"]
    assert parser.feed(b":Sr12:34:56#") == ["Sr12:34:56"] and parser.feed(b":Sr12:3:GR#") == ["GR"]
    assert parser.feed(b"x" * 1000) == [] and len(parser._rest) <= 41
    assert parser.feed(b":S" + b"y" * 39) == [] and parser.feed(b"#") == ["S" + "y" * 39]


def test_answers_of_what_came_together_go_together() -> None:
    _, box = session()
    assert asyncio.run(box.feed(b":Gc#:GVP#:Gt#")) == b"24#schmidt#+29\xdf22#"
    assert asyncio.run(box.feed(b":")) == b""


@pytest.mark.parametrize(("text", "value"), [
    ("59:59.9", 59 + 59.9 / 60), ("12:34:59.5", 12 + 34 / 60 + 59.5 / 3600), ("0:00:00", 0.0),
    ("-0:30", -0.5),
    ("12'34'56", 12 + 34 / 60 + 56 / 3600), ("12 34 56", 12 + 34 / 60 + 56 / 3600), ("12:60", None),
    ("12:59:60", None),
    ("1234:00", None), ("12:123", None), ("12:59.99", 12 + 59.99 / 60),
])  # fmt: skip
def test_angles_are_read_by_hand(text: str, value: float | None) -> None:
    if value is not None:
        assert angles.parse(text) == pytest.approx(value)
        return
    with pytest.raises(ValueError, match=r"is no angle|60 or more"):
        angles.parse(text)


def test_angles_are_written_by_hand() -> None:
    second = math.pi / 648000
    assert (
        angles.hours(15 * second * 3661) == "01:01:01"
        and angles.hours(15 * second * 3661, False) == "01:01.0"
    )
    assert angles.hours(2 * math.pi - 15 * second * 2.9, False) == "00:00.0"
    assert angles.hours(15 * second * 86399) == "23:59:59" and angles.hours(math.pi, False) == "12:00.0"
    assert (
        angles.signed(second * 36610) == "+10\xdf10:10"
        and angles.signed(-second * 36610, False, "'") == "-10\xdf10"
    )
    assert angles.signed(0.0) == "+00\xdf00:00" and angles.signed(second * 3661, True, "'") == "+01\xdf01'01"
    assert (
        angles.unsigned(-second) == "359\xdf59:59" and angles.unsigned(second * 1295999.6) == "000\xdf00:00"
    )
    assert (
        angles.unsigned(second * 1295999, False) == "000\xdf00"
        and angles.unsigned(math.pi, False) == "180\xdf00"
    )
