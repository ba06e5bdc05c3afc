"""The parser: the same commands however the bytes are cut, rubbish skipped, torn commands cost themselves."""

from hypothesis import given
from hypothesis import strategies as st

from host.lx200.session import Parser

COMMANDS = st.sampled_from(["GR", "Sr12:34:56", "Sd+12\xdf34:56", "MS", "Q", "Mgn2000", "\x06", "SG-5.5"])


def written(command: str) -> bytes:
    return (command if command == "\x06" else f":{command}#").encode("latin-1")


@given(st.lists(COMMANDS, max_size=20), st.lists(st.integers(0, 200), max_size=20), st.data())
def test_cut_anywhere_with_rubbish_between(commands: list[str], cuts: list[int], data: st.DataObject) -> None:
    rubbish = st.binary(max_size=6).map(lambda b: bytes(x for x in b if x not in b":\x06"))
    stream = b"".join(data.draw(rubbish) + written(command) for command in commands)
    parser, found, start = Parser(), [], 0
    for cut in [*sorted(min(cut, len(stream)) for cut in cuts), len(stream)]:
        found += parser.feed(stream[start:cut])
        start = cut
    assert found == commands


@given(st.binary(max_size=300))
def test_any_bytes_give_the_same_whole_or_singly(data: bytes) -> None:
    whole, singly = Parser(), Parser()
    assert whole.feed(data) == [each for byte in data for each in singly.feed(bytes([byte]))]
    assert all(len(command) <= 41 for command in Parser().feed(data))


def test_a_torn_command_costs_itself_only() -> None:
    assert Parser().feed(b":Sr12:3:GR#") == ["GR"]
    assert Parser().feed(b"#:GR#") == ["GR"]
    assert Parser().feed(b":Sr 12:34:56#:Sd +01\xdf02:03#") == ["Sr 12:34:56", "Sd +01\xdf02:03"]
    assert Parser().feed(b":" + b"9" * 5000 + b"#:GD#") == ["GD"]
    assert Parser().feed(b":Sr12\x06:GR#") == ["\x06", "GR"]
