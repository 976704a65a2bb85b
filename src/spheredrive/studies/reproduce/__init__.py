"""The thesis rebuilt: every figure, table and numeric claim, with a verdict on each, as one folder of files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from spheredrive.errors import InputError

if TYPE_CHECKING:
    from spheredrive.studies.reproduce.table import Row

__all__ = ["Reproduction", "reproduce", "rows"]

# Rows, figures and studies, for the progress bar.
STEPS = 1 + 27 + 7


class Reproduction(NamedTuple):
    """The rows of the comparison, and the files written: the page first."""

    rows: tuple[Row, ...]
    files: tuple[Path, ...]


def rows() -> tuple[Row, ...]:
    """All claims of the thesis with their verdicts."""
    from spheredrive.studies.reproduce.claims import all_rows

    return all_rows()


def reproduce(folder: str | Path, watch: Callable[[float], None] | None = None) -> Reproduction:
    """Rebuild the thesis into ``folder``: index.html, rows.json, and an SVG and a CSV for every figure.

    The folder is made if it does not exist; files of the same name are replaced, each whole or not at all. ``watch`` is told
    the share that is done. Equal versions write equal files: no clock, no random names. Raises ``InputError`` where a file
    cannot be written.
    """
    import json
    import warnings

    from spheredrive.errors import NearSingularWarning
    from spheredrive.io.files import write_whole
    from spheredrive.studies.parameters import studies
    from spheredrive.studies.reproduce.drawing import standalone
    from spheredrive.studies.reproduce.figures import figures
    from spheredrive.studies.reproduce.page import Shown, page

    target = Path(folder)
    _make(target)
    files: list[Path] = [target / "index.html"]
    tell = watch or (lambda share: None)
    done = 0

    def written(drawing, conclusion: str = "") -> Shown:
        nonlocal done
        svg = drawing.svg()
        for suffix, content in ((".svg", standalone(svg)), (".csv", drawing.csv())):
            files.append(target / f"{drawing.key}{suffix}")
            write_whole(files[-1], content)
        done += 1
        tell(done / STEPS)
        return Shown(drawing.key, drawing.title, drawing.caption, svg, conclusion)

    with warnings.catch_warnings():
        # Sweeps pass near singular layouts on purpose.
        warnings.simplefilter("ignore", NearSingularWarning)
        found = rows()
        tell(1 / STEPS)
        drawn = [written(drawing) for drawing in figures()]
        studied = [written(study.drawing, study.conclusion) for study in studies()]
    write_whole(target / "rows.json", json.dumps([row.as_dict() for row in found], indent=2, ensure_ascii=False) + "\n")
    files.append(target / "rows.json")
    write_whole(files[0], page(found, drawn, studied))
    return Reproduction(found, tuple(files))


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise InputError("is a file; name a folder", path=str(folder)) from None
    except OSError as error:
        raise InputError(f"cannot be made: {(error.strerror or str(error)).lower()}", path=str(folder)) from None
