"""Options of commands: numbers that are some, records from words, and one line of what is wrong."""

import re
import sys
from dataclasses import MISSING, dataclass
from types import SimpleNamespace
from typing import Any

import click
import pytest
from click.testing import CliRunner

from scenarios import options
from scenarios.options import SECONDS, SEED, SPEED, argument, fail, filled, option

REQUIRES = [
    "numpy>=2", 'pyarrow<30,>=15; extra == "parquet"', 'matplotlib>=3.8; extra == "plots"',
    'no-such-thing==1; extra == "odd"', 'schmidt[odd,plots]; extra == "all"',
]  # fmt: skip


@dataclass
class Record:
    file: str = argument(MISSING)
    must: str = option("Needed.", "-m", default=MISSING)
    often: int = option("How often.", type=int, default=3)
    a_word: str | None = option("A word.", **options.WORD)
    kept: int = 7


@click.command()
@filled(Record)
def told(record: Record) -> None:
    click.echo(repr(record))


def said(command: Any, *words: str) -> tuple[int, str]:
    done = CliRunner().invoke(command, list(words))
    return done.exit_code, done.output


def test_a_record_is_filled_from_words() -> None:
    assert said(told, "f", "-m", "x") == (0, f"{Record('f', 'x', 3)}\n")
    assert said(told, "f", "-m", "x", "--often", "4", "--a-word", "w") == (0, f"{Record('f', 'x', 4, 'w')}\n")
    assert "Missing option '-m'" in said(told, "f")[1]
    assert "Missing argument 'FILE'" in said(told, "-m", "x")[1]


@pytest.mark.parametrize(("word", "good"), [("a", True), ("a b", False), (" a", False), ("", False)])
def test_a_word_is_one(word: str, good: bool) -> None:
    status, output = said(told, "f", "-m", "x", "--a-word", word)
    assert (status == 0) is good and ("it is one word, without blanks" in output) is not good


@pytest.mark.parametrize(("kind", "text", "good"), [
    (SPEED, "0.01", True), (SPEED, "0.0099", False), (SPEED, "1000", True), (SPEED, "1000.1", False),
    (SPEED, "nan", False), (SECONDS, "0", False), (SECONDS, "1e-9", True), (SECONDS, "1e7", True),
    (SECONDS, "10000000.5", False), (SEED, "0", True), (SEED, "-1", False),
    (SEED, "9223372036854775807", True), (SEED, "9223372036854775808", False),
])  # fmt: skip
def test_bounds_of_numbers(kind: Any, text: str, good: bool) -> None:
    if good:
        assert float(kind.convert(text, None, None)) == float(text)
    else:
        with pytest.raises(click.BadParameter):
            kind.convert(text, None, None)


@pytest.mark.parametrize(("words", "muted"), [
    ((), "None"), (("--mute", "A", "--feed", "log"), "('A', PosixPath('log'))"),
    (("--mute", "A"), None), (("--feed", "log"), None),
])  # fmt: skip
def test_a_muted_board_needs_its_log(words: tuple[str, ...], muted: str | None) -> None:
    @click.command()
    @options.muting
    def command(muted: object) -> None:
        click.echo(repr(muted))

    status, output = said(command, *words)
    if muted is None:
        assert status == 2 and "--mute BOARD and --feed LOG go together" in output
    else:
        assert (status, output) == (0, f"{muted}\n")


def test_doors_are_asked_by_name() -> None:
    one = SimpleNamespace(name="hid", repeatable=False, form="F", help="h")
    many = SimpleNamespace(name="can", repeatable=True, form="F", help="h")

    @click.command()
    @options.doors(one, many)
    def command(asked: object) -> None:
        click.echo(repr(asked))

    assert said(command) == (0, "{'can': ()}\n")
    assert said(command, "--can", "a", "--can", "b", "--hid", "c") == (
        0,
        "{'hid': ('c',), 'can': ('a', 'b')}\n",
    )
    assert re.search(r"--hid F.*\n? *--can F", said(command, "--help")[1])


@pytest.mark.parametrize(("text", "line"), [
    ("a\n b", "a b"), ("x" * 600, "x" * 600), ("x" * 300 + "-" + "y" * 300, "x" * 300 + " … " + "y" * 300),
    ("a\0b", "a\\0b"), ("a\ud800b", "a\\ud800b"),
])  # fmt: skip
def test_a_failure_is_a_line_that_is_not_too_long(
    text: str, line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        fail(text, 3, ["more"])
    assert left.value.code == 3
    assert capsys.readouterr() == ("", f"schmidt: {line}\nschmidt: more\n")


def test_what_is_not_installed_is_told_with_its_versions(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(options, "requires", lambda _: REQUIRES)
    options.need("parquet", "plots")
    for extra in ("odd", "all"):
        with pytest.raises(ValueError, match=rf"^not installed: no-such-thing \(extra {extra}\); ") as caught:
            options.need("plots", extra)
        more = "" if extra == "odd" else ' "matplotlib>=3.8"'
        assert str(caught.value).endswith(f' -m pip install "no-such-thing==1"{more}')
    assert options.advice("no_such_thing.inner").startswith("not installed: no-such-thing (extra odd); ")
    assert options.advice("numpy") == options.advice("nothing") == ""
    assert options.advice("matplotlib").endswith('(extra plots); ' + sys.executable
                                                + ' -m pip install "matplotlib>=3.8"')  # fmt: skip
