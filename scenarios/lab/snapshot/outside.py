"""Who stands in a restored network where somebody of the outside listened: nobody."""

from collections.abc import Callable
from typing import Any


def nothing(*_arguments: Any) -> None:
    """What nobody does with what it is told."""


class Nobody:
    """In the place of a door, a log or a host: whatever it is called by, it does nothing."""

    def __getattr__(self, name: str) -> Callable[..., None]:
        if name.startswith("__"):
            raise AttributeError(name)
        return nothing

    def __call__(self, *_arguments: Any) -> None:
        """Nothing."""
