"""The other end of the control plane: one command, one answer."""

import socket

from scenarios.doors.address import address
from scenarios.doors.control import ControlError

_PATIENCE_S = 5.0
_ANSWER_S = 60.0
"""A snapshot on a busy machine takes its time."""


def tell(command: str, at: str, token: str | None = None) -> str:
    """Send a command to the server `at` [HOST:]PORT; returns its answer, or raises ControlError."""
    host, port = address(at, "--at")
    lines = ([f"token {token}"] if token else []) + [" ".join(command.split())]
    try:
        with (
            socket.create_connection((host, port), _PATIENCE_S) as connection,
            connection.makefile("rw", encoding="utf-8", newline="\n") as stream,
        ):
            connection.settimeout(None if command.startswith(("step", "join")) else _ANSWER_S)
            answer = ""
            for line in lines:
                stream.write(line + "\n")
                stream.flush()
                answer = stream.readline().rstrip("\n")
                if not answer.startswith("ok"):
                    break
    except ConnectionRefusedError:
        what = f"nobody listens; start schmidt serve --control {port} first"
        raise ControlError(f"{host}:{port}: {what}") from None
    except (OSError, UnicodeError) as error:
        raise ControlError(f"{host}:{port}: no answer: {error}") from None
    if not answer.startswith("ok"):
        raise ControlError(f"{host}:{port}: {answer.removeprefix('error: ') or 'no answer'}")
    return answer.removeprefix("ok").strip()
