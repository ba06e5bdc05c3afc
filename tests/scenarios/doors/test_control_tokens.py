"""Clients of other machines at the control plane: who needs a token, and which one."""

import pytest

from scenarios.doors.control import TOKEN_VARIABLE, ControlDoor
from tests.scenarios.doors.controldesk import FAR, Desk
from tests.scenarios.doors.served import stub_served


def test_another_machine_needs_the_token() -> None:
    desk = Desk(FAR)
    assert desk("status") == "error: this needs a token: token WORD\n"
    assert desk.door.refused == 1
    assert desk("token word") == "ok\n"
    assert desk("pause") == "ok paused\n" and desk.door.refused == 1


@pytest.mark.parametrize("line", ["token other", "token", "token word word"])
def test_a_wrong_token_is_hung_up_on(line: str) -> None:
    desk = Desk(FAR)
    assert desk(line) == "error: wrong token\n"
    assert desk.client.gone and desk.door.refused == 1 and not desk.clients.all


def test_who_was_trusted_and_left_is_forgotten() -> None:
    desk = Desk(FAR)
    desk("token word")
    desk.client.gone = True
    desk.door.poll(0)
    assert not desk.door._trusted and not desk.door._rest
    assert desk.door.state() == "1 clients"


def test_the_state_tells_who_was_refused() -> None:
    desk = Desk(FAR)
    desk("status")
    assert "1 refused for want of a token" in desk.door.state()


def test_a_name_has_the_token_where_it_was_made_up(monkeypatch: pytest.MonkeyPatch) -> None:
    served = stub_served()
    monkeypatch.delenv(TOKEN_VARIABLE, raising=False)
    made = ControlDoor(f"{FAR}:7411", None, served)
    assert made.name == f"--control {FAR}:7411 (token {made.token})" and len(made.token) >= 16
    assert ControlDoor(f"{FAR}:7411", "w", served).name == f"--control {FAR}:7411 (with your token)"
    assert ControlDoor("7411", None, served).name == "--control 7411"
    monkeypatch.setenv(TOKEN_VARIABLE, "of the environment")
    assert ControlDoor("7411", None, served).token == "of the environment"
    assert ControlDoor("7411", "mine", served).token == "mine"
