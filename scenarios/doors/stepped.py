"""The other end of the control plane: one command and its answer, or a client that steps time."""

import socket
from contextlib import AbstractContextManager

from bus.can import Frame
from bus.can.candump import parsed
from host.logs.files import reason
from scenarios.doors.clients import address
from scenarios.doors.livenetwork import frame_text

_PATIENCE_S = 5.0
_ANSWER_S = 60.0  # A snapshot on a busy machine takes its time.


class Stepped(AbstractContextManager["Stepped"]):
    """Joins the network served at [HOST:]PORT, once `clients` have (docs/guides/stepped-host.md).

    Time goes on in its calls and stands between them. clients: 0: it only talks. name: puts its frames in
    order with those of others.
    token: for servers of another machine. Raises ValueError for what is refused, OSError.
    """

    def __init__(self, at: str, name: str = "", clients: int = 1, token: str | None = None) -> None:
        self._socket = socket.create_connection(address(at, "at"), _PATIENCE_S)
        self._socket.settimeout(None)
        self._stream = self._socket.makefile("rw", encoding="utf-8", newline="\n")
        self.now_ns = 0
        """Simulated time after the last step."""
        if token is not None:
            self.ask(f"token {token}")
        if clients:
            self.ask(f"join {clients} {name}")
            self.ask("listen")

    def ask(self, command: str) -> str:
        """A line of the control plane; its answer without `ok`."""
        return self._said(command)[1]

    def _said(self, command: str) -> tuple[list[tuple[int, Frame]], str]:
        self._stream.write(command + "\n")
        self._stream.flush()
        heard = []
        while True:
            text = self._stream.readline().rstrip("\n")
            if text.startswith("("):
                found = parsed(text)
                assert found is not None, text
                heard.append(found)
            elif text.startswith("ok"):
                return heard, text[3:]
            else:
                raise ValueError(text.removeprefix("error: ") or "the server has gone")

    def send(self, identifier: int, data: bytes) -> None:
        """A frame, with the next step."""
        self.ask("send " + frame_text(Frame(identifier, data)))

    def step(self, span: str) -> list[tuple[int, Frame]]:
        """Let time go on by `5 ms`; every frame of the bus meanwhile, and when it ended, ns."""
        heard, now = self._said(f"step {span}")
        self.now_ns = int(now)
        return heard

    def __exit__(self, *_error: object) -> None:
        """Leave; nobody waits for it any more."""
        self._stream.close()
        self._socket.close()


def tell(command: str, at: str, token: str | None = None) -> str:
    """Send a command to the server `at` [HOST:]PORT; returns its answer, or raises ValueError."""
    host, port = address(at, "--at")
    try:
        with Stepped(at, clients=0, token=token or None) as plane:
            plane._socket.settimeout(None if command.startswith(("step", "join")) else _ANSWER_S)
            return plane.ask(" ".join(command.split())).strip()
    except ConnectionRefusedError:
        why = f"nobody listens; start schmidt serve --control {port} first"
    except (OSError, UnicodeError) as error:
        why = f"no answer: {reason(error)}"
    except ValueError as error:
        why = str(error)
    raise ValueError(f"{host}:{port}: {why}")
