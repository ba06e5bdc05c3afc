"""`schmidt control`: where nobody listens, the line says what to start."""

import pytest

from scenarios.doors.clients import listen
from scenarios.doors.stepped import tell
from tests.ports import free_ports


def test_where_nobody_listens_the_line_names_the_command() -> None:
    port = free_ports(1)
    with pytest.raises(ValueError) as caught:
        tell("status", str(port))
    assert (
        str(caught.value) == f"127.0.0.1:{port}: nobody listens; start schmidt serve --control {port} first"
    )


def test_the_systems_reason_stands_without_its_number() -> None:
    for fails in (lambda: tell("status", "nowhere.invalid:1"), lambda: listen("nowhere.invalid", 1)):
        with pytest.raises((ValueError, OSError), match=r"nowhere\.invalid:1.*: ") as caught:
            fails()
        assert "errno" not in str(caught.value).lower()
