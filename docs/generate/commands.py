"""docs/reference/commands.md: every command with its help, its options and an example, from click."""

from collections.abc import Iterator

import click

from docs.generate.text import MADE, cell, linked, prose, table
from scenarios.cli import SECTIONS, cli

_HEAD = """# Commands

{made}
`schmidt COMMAND --help` prints the same. The exit status is 0 when all is well and 1 when an expectation or a
check is missed. Unusable input is 2, with one line that says what, where and what to do; an interrupted
command is 130.
"""


def _usage(command: click.Command, path: str, context: click.Context) -> str:
    return " ".join([path, *command.collect_usage_pieces(context)])


def _options(command: click.Command, context: click.Context) -> str:
    options = [each for each in command.params if isinstance(each, click.Option)]
    records = [each.get_help_record(context) for each in options]
    rows = [[f"`{cell(name)}`", linked(text)] for name, text in filter(None, records)]
    return table(["option", "does"], rows) if rows else ""


def _section(command: click.Command, path: str, depth: int, example: str | None) -> Iterator[str]:
    context = click.Context(command, info_name=path, show_default=True)
    yield f"\n{'#' * depth} {path}\n"
    yield f"\n{prose(command.help or '')}\n"
    yield f"\n    {_usage(command, path, context)}\n"
    if example:
        yield f"\nFor example:\n\n    {example}\n"
    yield _options(command, context)
    if isinstance(command, click.Group):
        for name in command.list_commands(context):
            each = command.get_command(context, name)
            if each is not None:
                yield from _section(each, f"{path} {name}", depth + 1, None)


def page() -> str:
    """The whole page, Markdown."""
    lines = [_HEAD.format(made=MADE.format(source="the command line itself (`scenarios/commands`)"))]
    for title, section in SECTIONS.items():
        lines.append(f"\n## {title}\n")
        for command, example in section:
            lines += _section(command, f"{cli.name} {command.name}", 3, example)
    return "".join(lines)
