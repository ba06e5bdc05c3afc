"""What a calibration is asked for beside its logs."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True, kw_only=True)
class Options:
    """Files to hold out, folder to write into, declared plant file, whether to replay, whom to tell."""

    hold_out: list[str] = field(default_factory=list)
    out: Path = Path(".")
    plant: Path | None = None
    replay: bool = True
    tell: Callable[[str], None] = lambda _: None
