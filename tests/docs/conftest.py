"""Declared boards are known to a whole process: what a test declares is forgotten after it."""

from collections.abc import Iterator

import pytest

from bus.protocol import LAYOUTS
from bus.protocol.names import DECLARED, DECLARED_OPCODES
from bus.protocol.nodes import kind
from scenarios.nodes import BOARDS


@pytest.fixture
def forget_boards() -> Iterator[None]:
    tables = (LAYOUTS, DECLARED, DECLARED_OPCODES, BOARDS, kind._kinds, kind._by_type)
    before = [dict(table) for table in tables]
    yield
    for table, kept in zip(tables, before, strict=True):
        table.clear()
        table.update(kept)  # type: ignore[arg-type]
