import pytest

from bus.protocol import page
from bus.protocol.database import database


def test_the_committed_page_is_what_the_dbc_gives(capsys: pytest.CaptureFixture[str]) -> None:
    assert page.main(["--check"]) == 0, capsys.readouterr().err


def test_the_page_shows_every_signal() -> None:
    text = page.page()
    for message in database().messages:
        for signal in message.signals:
            assert f"| {signal.name} |" in text


def test_an_old_page_is_noticed(tmp_path, monkeypatch, capsys) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr(page, "PAGE_PATH", tmp_path / "protocol.md")
    assert page.main(["--check"]) == 1
    assert "python -m bus.protocol.page" in capsys.readouterr().err
    assert page.main([]) == 0
    assert page.main(["--check"]) == 0
