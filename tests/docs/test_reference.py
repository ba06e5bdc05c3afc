"""docs/reference: pages made from code are what the code gives, and say all there is."""

from pathlib import Path

import pytest

from bus.protocol import Device, Opcode
from docs.generate import __main__ as generate
from docs.generate.public import PUBLIC
from plant.effects import REGISTRY
from scenarios.cli import cli

REFERENCE = Path(__file__).parents[2] / "docs" / "reference"


def text_of(name: str) -> str:
    return (REFERENCE / name).read_text(encoding="utf-8")


@pytest.mark.parametrize("name", sorted(generate.PAGES.keys() - {"effects.md"}))  # that one is the plant's
def test_a_page_is_what_the_code_says(name: str) -> None:
    """Else run `python -m docs.generate`."""
    assert (REFERENCE / name).read_text(encoding="utf-8") == generate.PAGES[name]()


def test_an_old_page_is_noticed_and_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(generate, "REFERENCE", tmp_path)
    monkeypatch.setattr(generate, "PAGES", {"effects.md": generate.PAGES["effects.md"]})
    (tmp_path / "effects.md").write_text("old", encoding="utf-8")
    assert generate.main(["--check"]) == 1
    assert "python -m docs.generate" in capsys.readouterr().err
    assert generate.main([]) == 0
    assert generate.main(["--check"]) == 0


def test_every_command_with_every_option_is_on_its_page() -> None:
    page = text_of("commands.md")
    for name, command in cli.commands.items():
        section = page.split(f"\n### schmidt {name}\n")[1].split("\n### ")[0]
        assert "For example:\n\n    schmidt " in section
        for option in (each for each in command.params if each.param_type_name == "option"):
            assert any(f"`{word}" in section or f", {word}" in section for word in option.opts), option.name


def test_every_effect_has_a_section_with_its_parameters() -> None:
    page = text_of("effects.md")
    for name, effect in REGISTRY.items():
        section = page.split(f"\n## {name}\n")[1].split("\n## ")[0]
        assert all(f"| `{each.name}` |" in section for each in effect.parameters)


def test_every_public_name_has_its_import_and_a_docstring() -> None:
    page = text_of("api.md")
    for _, entries in PUBLIC.values():
        for module, name in (entry.split(":") for entry in entries):
            after = page.split(f"from {module} import {name}\n")[1]
            assert not after.split("```\n")[1].strip().startswith("#"), f"{module}: {name} has no docstring"


def test_every_device_and_opcode_is_on_the_protocols_page() -> None:
    page = text_of("protocol.md")
    assert all(f"| {device.name} | {device.value:#04x} |" in page for device in Device)
    assert all(f"{opcode.value} {opcode.name}" in page for opcode in Opcode if "FOCUS" not in opcode.name)
