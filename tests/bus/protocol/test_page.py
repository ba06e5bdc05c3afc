from pathlib import Path

from bus.protocol import page
from bus.protocol.database import database

PUBLISHED = Path(__file__).parents[3] / "docs" / "reference" / "protocol.md"


def test_the_page_shows_every_signal() -> None:
    text = page.page()
    for message in database().messages:
        for signal in message.signals:
            assert f"| {signal.name} |" in text


def test_the_page_is_the_one_that_hosts_were_written_from() -> None:
    assert page.page() == PUBLISHED.read_text(encoding="utf-8")
