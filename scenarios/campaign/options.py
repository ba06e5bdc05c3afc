"""Options of `schmidt campaign`. Light: the command line imports it."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, kw_only=True)
class CampaignOptions:
    """file: the campaign, or the name of one of schmidt's own. out: folder; None: out/ and the file's name.
    jobs: processes (None: one per core); scheduler: a Dask scheduler instead. resume: go on with what is in
    the folder."""

    file: Path
    out: Path | None = None
    jobs: int | None = None
    scheduler: str | None = None
    resume: bool = False

    @property
    def folder(self) -> Path:
        """Where everything goes."""
        return Path("out") / self.file.stem if self.out is None else self.out
