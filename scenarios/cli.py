"""The command `schmidt`. Commands import what they need when they are called, so that it starts at once."""

from __future__ import annotations

import signal

import click

from scenarios.commands import calibrating, describing, many, running, serving
from scenarios.commands.endings import INTERRUPTED, UNUSABLE, fail

COMMANDS = (
    running.run,
    serving.serve,
    serving.host,
    serving.replay,
    serving.control,
    many.campaign,
    many.paper,
    many.objective,
    calibrating.calibrate,
    calibrating.rig,
    describing.conformance,
    describing.eds,
    describing.protocol,
    describing.effects,
)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="schmidt", prog_name="schmidt")
def cli() -> None:
    """Emulator of the 50/80 cm Schmidt telescope's microcontroller network, and its calibration."""


for _command in COMMANDS:
    cli.add_command(_command)


def _terminate(_signal: int, _frame: object) -> None:
    raise KeyboardInterrupt


def main() -> None:
    """Run the command; whatever goes wrong is one line, never a traceback."""
    signal.signal(signal.SIGTERM, _terminate)
    try:
        cli.main(standalone_mode=False)
    except click.exceptions.Abort:
        fail("interrupted", INTERRUPTED)
    except click.ClickException as error:
        fail(" ".join(error.format_message().split()), UNUSABLE)
    except KeyboardInterrupt:
        fail("interrupted", INTERRUPTED)
    except (ValueError, OSError) as error:
        fail(" ".join(str(error).split()), UNUSABLE)
    except ImportError as error:
        fail(f"this command needs a part that is not installed: {error}", UNUSABLE)
    except MemoryError:
        fail("there is not enough memory for this", UNUSABLE)
    except RecursionError:
        fail("the input is nested too deeply", UNUSABLE)
    except Exception as error:
        fail(f"internal error, please report it: {type(error).__name__}: {' '.join(str(error).split())}", 70)
