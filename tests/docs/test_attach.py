"""docs/guides/attach-a-host.md: its commands are run as they stand there, door by door."""

import contextlib
import os
import re
import shlex
import shutil
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import can
import cantools
import pytest
import serial
from alpaca.telescope import Telescope

from tests.doors.process import PROGRAM, ROOT

GUEST = ("--can socketcan:vcan0", "--hid uhid")
"""Doors that need a kernel of their own: `make guest` runs them."""
WAIT_S = 60.0
pytestmark = [
    pytest.mark.slow,
    pytest.mark.timeout(300),
    pytest.mark.xdist_group("attach"),  # the page's ports serve one worker only
    pytest.mark.filterwarnings("ignore:setDaemon"),  # in pyserial
]


class Row(NamedTuple):
    """A door: the option of `serve`, and the first code in the column beside it."""

    door: str
    option: str
    code: str


def text_of(page: str) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


def rows(page: str = "docs/guides/attach-a-host.md") -> list[Row]:
    found = re.findall(r"^\| ([^|]+) \| `(--[^`|]+)` \| (?:[^`|]*?)`([^`|]+)`", text_of(page), re.M)
    return [Row(*each) for each in found]


def command() -> list[str]:
    """The one line that opens all doors which need no kernel of their own."""
    lines = text_of("docs/guides/attach-a-host.md").splitlines()
    line = max((line for line in lines if line.startswith("    schmidt serve")), key=len)
    return shlex.split(line)[1:]


def schmidt(words: list[str], folder: Path) -> dict[str, Any]:
    """Arguments of Popen: the command as a user in `folder` gives it."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    return {"args": [sys.executable, "-c", PROGRAM, *words], "cwd": folder, "env": environment}


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    folder = tmp_path_factory.mktemp("attach")
    for port in sorted({int(number) for number in re.findall(r"\b(?:7501|4030|8080|11111|7411)\b",
                                                             " ".join(command()))}):  # fmt: skip
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                pytest.skip(f"port {port} of the page is in use on this machine")
    with (folder / "said").open("w") as said, subprocess.Popen(
        **schmidt(command(), folder), stdout=said, stderr=subprocess.STDOUT
    ) as process:  # fmt: skip
        end = time.monotonic() + 180
        while "serving" not in (folder / "said").read_text():
            assert process.poll() is None and time.monotonic() < end, (folder / "said").read_text()
            time.sleep(0.1)
        yield folder
        subprocess.run(**schmidt(["control", "stop"], folder), check=True, stdout=subprocess.DEVNULL)
        assert process.wait(60) == 0


def hears_frames(code: str) -> bool:
    with eval(code, {"can": can}) as bus:
        return bus.recv(WAIT_S) is not None


def hears_bytes(code: str) -> bool:
    with contextlib.closing(eval(code, {"serial": serial})) as port:
        port.timeout = WAIT_S
        return len(port.read(4)) == 4


def hears_reports(code: str) -> bool:
    names: dict[str, Any] = {"socket": socket}
    exec(code, names)
    with names["s"] as s:
        s.settimeout(WAIT_S)
        return len(s.recv(64)) == 64


def lx200(connection: Any, send: Callable[[bytes], Any], read: Callable[[int], bytes]) -> bool:
    with contextlib.closing(connection):
        send(b":GR#")
        said = b""
        while not said.endswith(b"#"):
            got = read(1)
            assert got, "no answer to :GR#"
            said += got
    return re.fullmatch(rb"\d\d:\d\d(:\d\d|\.\d)#", said) is not None


def lx200_tcp(code: str) -> bool:
    connection = eval(code, {"socket": socket})
    connection.settimeout(WAIT_S)
    return lx200(connection, connection.sendall, connection.recv)


def lx200_serial(code: str) -> bool:
    port = eval(code, {"serial": serial})
    port.timeout = WAIT_S
    return lx200(port, port.write, port.read)


def alpaca(code: str) -> bool:
    telescope = eval(code, {"Telescope": Telescope})
    telescope.Connected = True
    return 0 <= telescope.RightAscension < 24


def page(code: str) -> bool:
    with urllib.request.urlopen(code, timeout=WAIT_S) as answer:
        return answer.status == 200 and b"Schmidt telescope" in answer.read()


def status(code: str) -> bool:
    words = shlex.split(code)
    done = subprocess.run(**schmidt(words[1:], ROOT), capture_output=True, text=True, check=True)
    return words[0] == "schmidt" and "boards" in done.stdout


CHECKS: dict[str, Callable[[str], bool]] = {
    "--can udp_multicast:239.74.163.2": hears_frames,
    "--serial pty:out/ports": hears_bytes,
    "--serial tcp:7501": hears_bytes,
    "--hid unix:out/gateway.sock": hears_reports,
    "--lx200 4030": lx200_tcp,
    "--lx200 pty:out/lx200": lx200_serial,
    "--console 8080": page,
    "--alpaca 11111": alpaca,
    "--control 7411": status,
}


def test_the_readmes_doors_are_attached_to_as_those_of_the_page() -> None:
    """So what README says is run here, too."""
    page = {row.option: row.code for row in rows()}
    readme = {row.option: row.code for row in rows("README.md")}
    assert len(readme) == 4
    assert readme.items() <= page.items()


def test_every_door_of_the_page_is_run_here_or_in_the_guest() -> None:
    assert {row.option for row in rows()} == {*CHECKS, *GUEST}
    said = " ".join(command())
    assert all(option in said for option in CHECKS)
    guest = "\n".join(path.read_text() for path in (ROOT / "tests" / "guest").iterdir() if path.is_file())
    assert all(option in guest for option in GUEST)


@pytest.mark.parametrize("row", rows(), ids=lambda row: row.option.replace("--", "").replace(" ", "-"))
def test_a_door_is_attached_to_as_the_page_says(
    row: Row, served: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if row.option in GUEST:
        pytest.skip("needs a kernel with vcan and uhid: make guest")
    monkeypatch.chdir(served)
    assert CHECKS[row.option](row.code), row


def test_the_host_of_the_page_moves_an_axis_by_a_degree(served: Path) -> None:
    """The program as it stands there; where the axis is, another program hears."""
    program = text_of("docs/guides/attach-a-host.md").partition("```python\n")[2].partition("```")[0]
    names: Any = cantools.database.load_file(ROOT / "bus/protocol/schmidt.dbc")
    position = names.get_message_by_name("POSITION_DEC_POSITION")

    def counts() -> int:
        with can.Bus(interface="udp_multicast", channel="239.74.163.2") as bus:
            heard = (bus.recv(WAIT_S) for _ in range(10_000))
            frame = next(f for f in heard if f is not None and f.arbitration_id == position.frame_id)
        return int(names.decode_message(frame.arbitration_id, frame.data)["Position"])

    before = counts()
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, timeout=120
    )
    assert done.stdout.endswith("arrived\n"), done.stderr
    degree = 2**29 / 360  # counts of the encoder
    assert abs(counts() - before - degree) < 0.02 * degree


@pytest.mark.skipif(shutil.which("indiserver") is None, reason="indi-bin is not installed")
def test_indis_lines_connect_and_say_where_the_telescope_points(served: Path) -> None:
    section = text_of("docs/guides/attach-a-host.md").partition("## From INDI")[2].partition("\n## ")[0]
    server, *lines = [shlex.split(line) for line in section.splitlines() if line.startswith("    ")]
    assert len(lines) == 4

    def said(words: list[str]) -> str:
        done = subprocess.run(words, cwd=served, capture_output=True, text=True, timeout=WAIT_S, check=False)
        return done.stdout if done.returncode == 0 else ""

    with subprocess.Popen(server, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        try:
            end = time.monotonic() + WAIT_S
            while not said(["indi_getprop", "-1", lines[0][1].partition("=")[0]]):  # the driver comes up
                assert time.monotonic() < end
            for words in lines[:-1]:
                said(words)
            while len(found := said(lines[-1]).splitlines()) != 2:
                assert time.monotonic() < end, found
        finally:
            process.terminate()
    assert all(re.search(r"=-?[\d.]+$", each) for each in found), found
