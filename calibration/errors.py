"""What the tool says when it cannot read an input: one line with the place and the way out."""

from pathlib import Path


class CalibrationInputError(ValueError):
    """An input that cannot be read: names the file and, where there is one, line and column."""

    def __init__(self, path: Path | str, message: str, line: int | None = None, column: str | None = None):
        place = str(path)
        if line is not None:
            place += f":{line}"
        if column is not None:
            place += f": column '{column}'"
        super().__init__(f"{place}: {message}")
        self.path, self.line, self.column = str(path), line, column
