from bus.protocol import page
from bus.protocol.database import database


def test_the_page_shows_every_signal() -> None:
    text = page.page()
    for message in database().messages:
        for signal in message.signals:
            assert f"| {signal.name} |" in text
