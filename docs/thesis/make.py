"""Write the page on the thesis from the program's own verdicts: python docs/thesis/make.py"""

import warnings
from pathlib import Path

from spheredrive.errors import NearSingularWarning
from spheredrive.studies.parameters import studies
from spheredrive.studies.reproduce import rows
from spheredrive.studies.reproduce.errata import ERRATA, number

HEAD = """# The thesis, claim by claim

A. Weiss's thesis on the Atlas spherical motion platform (Carleton University), rebuilt by `spheredrive reproduce -o thesis/`,
which draws every figure besides. Verdicts are computed. A star marks a verdict that rests on an assumption, because the text
leaves something open; the command's page says what.

{agree} of {count} claims agree.

| claim | thesis | here | verdict |
|---|---|---|---|
"""


def cell(text: str) -> str:
    """Text that stays in its cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")


def page() -> str:
    """The page in Markdown."""
    with warnings.catch_warnings():
        # Sweeps pass near singular layouts on purpose.
        warnings.simplefilter("ignore", NearSingularWarning)
        found, studied = rows(), list(studies())
    text = HEAD.format(agree=sum(row.agrees for row in found), count=len(found))
    for row in found:
        star = "*" if row.open else ""
        reason = f", {number(row.erratum)}" if row.erratum and not row.agrees else ""
        text += f"| `{row.id}` {cell(row.claim)} | {cell(row.thesis)} | {cell(row.here)} | {row.verdict}{star}{reason} |\n"
    text += "\n## Where the thesis is wrong\n\n"
    text += "".join(f"* **{number(key)}** {cell(words)}\n" for key, words in ERRATA.items())
    text += "\n## What the thesis leaves open (its section 5.1)\n\n"
    text += "".join(f"* **{study.drawing.title}.** {cell(study.conclusion)}\n" for study in studied)
    return text


if __name__ == "__main__":
    (Path(__file__).parent / "README.md").write_text(page(), encoding="utf-8")
