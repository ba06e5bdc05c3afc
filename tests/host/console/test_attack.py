"""A web page of somebody else's, in a browser of this machine, tries to command the telescope."""

import http.server
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.host.console.conftest import Consoles, opened
from tests.ports import free_ports

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]

_PAGE = """<!doctype html><title>kittens</title><script>
const found = {};
const tried = [];
const post = (name, url, body, kind, method) => tried.push(fetch(url, {
  method: method || 'POST', mode: 'no-cors', credentials: 'include', body, headers: {'Content-Type': kind},
}).then(answer => found[name] = answer.type, error => found[name] = 'failed'));
post('control', 'http://127.0.0.1:CONTROL/', 'pause\\n', 'text/plain');
post('lx200', 'http://127.0.0.1:LX200/', ':Sr05:00:00#:Sd+20*00:00#:MS#', 'text/plain');
post('alpaca', 'http://127.0.0.1:ALPACA/api/v1/telescope/0/tracking', 'Tracking=true',
     'application/x-www-form-urlencoded');
post('alpaca put', 'http://127.0.0.1:ALPACA/api/v1/telescope/0/tracking', 'Tracking=true',
     'application/x-www-form-urlencoded', 'PUT');
tried.push(fetch('http://127.0.0.1:CONSOLE/').then(answer => answer.text()).then(
  text => found.read = text.length, error => found.read = 'failed'));
tried.push(new Promise(done => {
  const socket = new WebSocket('ws://127.0.0.1:CONSOLE/_nicegui_ws/socket.io/?EIO=4&transport=websocket');
  socket.onopen = () => { found.websocket = 'open'; done(); };
  socket.onerror = () => { found.websocket = 'failed'; done(); };
}));
Promise.all(tried).then(() => window.found = found);
</script>"""


@pytest.fixture
def doors(tmp_path: Path) -> Iterator[dict[str, Any]]:
    lx200, alpaca = free_ports(), free_ports()
    words = ("--lx200", str(lx200), "--alpaca", str(alpaca))
    with Consoles(tmp_path, 1.0, "scenarios/observing-night.yaml", *words) as made:
        yield {"made": made, "LX200": lx200, "ALPACA": alpaca, "CONSOLE": made.port, "CONTROL": made.control}


@pytest.fixture
def foreign(doors: dict[str, Any]) -> Iterator[str]:
    """Address of a page of another origin."""
    text = _PAGE
    for word in ("LX200", "ALPACA", "CONSOLE", "CONTROL"):
        text = text.replace(word, str(doors[word]))

    class Page(http.server.BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(text.encode())

        def log_message(self, format: str, *args: object) -> None:
            pass

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Page) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


def test_a_foreign_page_commands_nothing(browser: Any, doors: dict[str, Any], foreign: str) -> None:
    made: Consoles = doors["made"]
    own = opened(browser, made, "/")
    idle = own.get_by_role("status").first.inner_text()
    page = browser.new_page()
    page.goto(foreign)
    page.wait_for_function("window.found")
    found = page.evaluate("window.found")
    assert found["control"] == found["lx200"] == "failed"  # they hang up on what begins like HTTP
    assert found["alpaca put"] == found["read"] == found["websocket"] == "failed"
    before = made.status()["simulated_s"]
    made.wait(before + 2.0)  # neither paused nor stopped
    assert own.get_by_role("status").first.inner_text() == idle
    own.close()
    page.close()
