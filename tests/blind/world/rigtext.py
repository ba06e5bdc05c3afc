"""A rig file as its owner would write it from the documentation, without a hint at what is hidden."""

from dataclasses import dataclass, field


@dataclass
class Rig:
    """The parts of a rig file."""

    name: str
    columns: list[str]  # logfile.told
    response: str
    estimate: tuple[str, ...] = ()
    stages: list[str] = field(default_factory=list)
    more: list[str] = field(default_factory=list)

    def text(self) -> str:
        """The YAML text."""
        lines = [f"rig: {self.name}", *self.columns, f"response: {{{self.response}}}"]
        if self.estimate:
            lines.append(f"estimate: [{', '.join(self.estimate)}]")
        if self.stages:
            lines += ["stages:", *(f"  - {{{stage}}}" for stage in self.stages)]
        return "\n".join(lines + self.more) + "\n"
