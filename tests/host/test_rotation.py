"""Log rotation (H6): nothing is lost, no line is cut, the oldest file goes first."""

from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from host.logs.journal import AsciiLogs, RotatingFile


@settings(max_examples=30, deadline=None)
@given(lines=st.lists(st.text("abcé ", max_size=30), max_size=60), full=st.integers(20, 200))
def test_all_lines_are_there_in_order_and_whole(
    tmp_path_factory: "object", lines: list[str], full: int
) -> None:
    folder: Path = tmp_path_factory.mktemp("logs")  # type: ignore[attr-defined]
    file = RotatingFile(folder / "x.log", full_bytes=full, kept=100)
    file.write("# head\n")
    for line in lines:
        file.write(line + "\n")
    file.close()
    names = [*sorted(folder.glob("x.log.*"), key=lambda path: -int(path.suffix[1:])), folder / "x.log"]
    found: list[str] = []
    for name in names:
        text = name.read_text(encoding="utf-8")
        assert text.startswith("# head\n") and text.endswith("\n")
        assert name.stat().st_size <= max(full, len("# head\n") + 64)
        found += text.split("\n")[1:-1]
    assert found == lines


def test_the_oldest_goes_and_an_earlier_session_is_kept(tmp_path: Path) -> None:
    for session in range(4):
        file = RotatingFile(tmp_path / "x.log", kept=2)
        file.write(f"session {session}\n")
        file.close()
    assert (tmp_path / "x.log").read_text() == "session 3\n"
    assert (tmp_path / "x.log.1").read_text() == "session 2\n"
    assert (tmp_path / "x.log.2").read_text() == "session 1\n"
    assert not (tmp_path / "x.log.3").exists()


def test_the_four_logs_rotate_when_asked(tmp_path: Path) -> None:
    for _ in range(2):
        logs = AsciiLogs(tmp_path, lambda t: f"{t:.1f}", RotatingFile)
        logs.error(0, "HOST", "something")
        logs.close()
    assert "something" in (tmp_path / "errors.log.1").read_text()
    assert "something" in (tmp_path / "errors.log").read_text()
