"""can.log through zstd: the same text, in pieces that stand alone."""

from pathlib import Path

import pyarrow
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from host.logs.files import LogError, ZstdFile


def unpacked(data: bytes) -> bytes:
    with pyarrow.CompressedInputStream(pyarrow.BufferReader(data), "zstd") as stream:
        return bytes(stream.read())


@settings(max_examples=30)
@given(st.lists(st.tuples(st.binary(max_size=300), st.booleans()), max_size=12))
def test_what_comes_out_is_what_went_in_however_it_was_flushed(
    tmp_path_factory: pytest.TempPathFactory, blocks: list[tuple[bytes, bool]]
) -> None:
    path = tmp_path_factory.mktemp("packed") / "can.log.zst"
    file = ZstdFile(path)
    for data, flush in blocks:
        assert file.write(data) == len(data)
        if flush:
            file.flush()
    file.close()
    file.close()
    found = path.read_bytes()
    assert (unpacked(found) if found else b"") == b"".join(data for data, _ in blocks)


def test_a_large_piece_is_on_disk_without_a_flush(tmp_path: Path) -> None:
    path = tmp_path / "can.log.zst"
    file = ZstdFile(path)
    line = b"(1.000129) can0 211#1101000000000000\n"
    for _ in range(40_000):
        file.write(line)
    before = path.read_bytes()
    assert unpacked(before).startswith(line)
    assert len(before) < len(line) * 40_000 // 20
    file.close()


def test_a_full_disk_is_said_in_one_line() -> None:
    file = ZstdFile(Path("/dev/full"))
    file.write(b"line\n")
    with pytest.raises(LogError, match="/dev/full: no space left"):
        file.flush()
    file.close()
