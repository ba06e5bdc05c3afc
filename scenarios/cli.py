"""The command `schmidt`. Commands import what they need when they are called, so that it starts at once."""

import signal
from collections.abc import Mapping

import click

from scenarios.commands import calibrating, describing, live, running
from scenarios.options import INTERRUPTED, UNUSABLE, advice, fail

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


SECTIONS: dict[str, Section] = {
    "Run a night": (
        (running.run, "schmidt run quick-look"),
        (running.campaign, "schmidt campaign campaign.yaml --out out/many"),
        (live.replay, "schmidt replay out/session"),
    ),
    "Attach your host": (
        (live.serve, "schmidt serve --lx200 4030 --control 7411"),
        (live.control, "schmidt control status"),
        (live.host, "schmidt host --usb /dev/hidraw0 --console 8080"),
    ),
    "Check a board": (
        (describing.conformance, "schmidt conformance --can socketcan:can0 --board axis:0x11"),
        (describing.protocol, "schmidt protocol"),
        (describing.eds, "schmidt eds out/eds"),
    ),
    "Calibrate a drive": (
        (calibrating.calibrate, "schmidt calibrate docs/example/*.csv --out out/example"),
        (calibrating.rig, "schmidt rig my-drive.yaml log.csv --plot columns.png"),
        (describing.effects, "schmidt effects gear_mesh"),
    ),
    "Take it elsewhere": (
        (describing.fmu, "schmidt fmu --axis ra --out drive.fmu"),
        (describing.export, "schmidt export out/quick-look --mcap night.mcap"),
    ),
    "Repeat the paper": (
        (running.paper, "schmidt paper --quick"),
        (running.objective, "schmidt objective --starts 1"),
    ),
}
HELP = "Emulator of the 50/80 cm Schmidt telescope's microcontroller network, and its calibration."
cli = click.version_option(package_name="schmidt", prog_name="schmidt")(
    Sections(
        SECTIONS,
        name="schmidt",
        help=HELP,
        context_settings={"help_option_names": ["-h", "--help"], "show_default": True},
    )
)


def _terminate(_signal: int, _frame: object) -> None:
    raise KeyboardInterrupt


def _said(error: OSError | ValueError) -> str:
    """The file first, as in all other errors, without the system's number."""
    if isinstance(error, OSError) and error.filename is not None and error.strerror is not None:
        return f"{error.filename}: {error.strerror.lower()}"
    return str(error)


def main() -> None:
    """Run the command; whatever goes wrong is one line, never a traceback."""
    signal.signal(signal.SIGTERM, _terminate)
    try:
        cli.main(standalone_mode=False)
    except (click.exceptions.Abort, KeyboardInterrupt):
        fail("interrupted", INTERRUPTED)
    except click.ClickException as error:
        fail(error.format_message(), UNUSABLE)
    except (OSError, ValueError) as error:
        fail(_said(error), UNUSABLE, getattr(error, "__notes__", ()))
    except ImportError as error:
        missing = f"this command needs a part that is not installed: {error}"
        fail(advice(error.name or "") or missing, UNUSABLE)
    except MemoryError:
        fail("there is not enough memory for this", UNUSABLE)
    except RecursionError:
        fail("the input is nested too deeply", UNUSABLE)
    except Exception as error:
        fail(f"internal error, please report it: {type(error).__name__}: {error}", 70)
