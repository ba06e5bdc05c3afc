"""Help of `schmidt`: commands in sections by what one wants to do, an example for each."""

from collections.abc import Mapping

import click

Section = tuple[tuple[click.Command, str], ...]
"""Commands with an example each."""


class Sections(click.Group):
    """A group whose help shows its commands in sections."""

    def __init__(self, sections: Mapping[str, Section], **settings: object) -> None:
        super().__init__(**settings)  # type: ignore[arg-type]
        self.sections = sections
        for section in sections.values():
            for command, _ in section:
                self.add_command(command)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the sections; below what a command does stands its example."""
        width = max(len(command.name or "") for section in self.sections.values() for command, _ in section)
        for title, section in self.sections.items():
            rows = []
            for command, example in section:
                name = (command.name or "").ljust(width)  # one column for all sections
                rows += [(name, command.get_short_help_str(limit=90)), ("", f"$ {example}")]
            with formatter.section(title):
                formatter.write_dl(rows)
