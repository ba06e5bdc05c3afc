"""Options of `schmidt campaign`. Light: the command line imports it."""

from dataclasses import MISSING, dataclass
from pathlib import Path

from scenarios.options import PATH, argument, jobs_option, option, scheduler_option


@dataclass(frozen=True, kw_only=True)
class CampaignOptions:
    """file: the campaign, or the name of one of schmidt's own."""

    file: Path = argument(type=PATH, default=MISSING)
    out: Path | None = option("Output folder (default: out/<campaign>).", type=PATH)
    jobs: int | None = jobs_option()
    scheduler: str | None = scheduler_option()
    resume: bool = option("Go on with what is in the folder.", default=False, is_flag=True)

    @property
    def folder(self) -> Path:
        """Where everything goes."""
        return Path("out") / self.file.stem if self.out is None else self.out
