"""The rows of the comparison, by subject; each file returns rows whose verdicts it works out."""

from __future__ import annotations

import re

from spheredrive.studies.reproduce.table import Row


def all_rows() -> tuple[Row, ...]:
    """All rows, by chapter and in the thesis's order within each subject."""
    from spheredrive.studies.reproduce.claims import (
        elastic,
        excitation,
        frequencies,
        kinematics,
        mecanum,
        races,
        resistance,
        rigid,
        sweeps,
    )

    subjects = (kinematics, races, mecanum, rigid, elastic, resistance, excitation, frequencies, sweeps)
    rows = [row for subject in subjects for row in subject.rows()]
    return tuple(sorted(rows, key=chapter))


def chapter(row: Row) -> int:
    """The chapter a row's name points to."""
    found = re.search(r"\d", row.id)
    assert found is not None, "a row is named after its place in the thesis"
    return int(found[0])
