"""The command line: one function a subcommand, each a thin edge over the functions it calls.

Results go to standard output, progress and notes to standard error. Exit 0: done; 1: done, and the findings say the design
does not work; 2: bad input. Imports stand inside the functions: a help text must not wait for a compiler.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

from cyclopts import App, CycloptsError, Parameter

import spheredrive
from spheredrive.errors import SpheredriveError

EXIT_DOES_NOT_WORK = 1
EXIT_BAD_INPUT = 2

app = App(
    name="spheredrive",
    help="Machines in which omnidirectional wheels drive a sphere: from a design file to an answer.",
    version=spheredrive.__version__,
    help_format="plaintext",
)

Json = Annotated[bool, Parameter(name="--json", negative="", help="Print the results as JSON.")]


@app.command
def check(design: Path, *, json: Json = False) -> int:
    """Say whether a design moves in every direction without slip, and how well.

    Parameters
    ----------
    design
        Design file (TOML).
    """
    from spheredrive.checking import check as work_out
    from spheredrive.io.design_file import load_design

    loaded = load_design(design)
    result = work_out(loaded)
    if json:
        _print_json(result.as_dict())
    else:
        from spheredrive.summary import check_text

        print(check_text(loaded, result))
    return 0 if result.works else EXIT_DOES_NOT_WORK


@app.command
def report(
    design: Path,
    motion: Path | None = None,
    *,
    output: Annotated[Path, Parameter(name=["-o", "--output"])] = Path("report.html"),
) -> int:
    """Write everything about a design into one HTML file.

    Parameters
    ----------
    design
        Design file (TOML).
    motion
        Motion file (TOML), for what changes over time.
    output
        The HTML file to write.
    """
    from spheredrive.checking import check as work_out
    from spheredrive.io.design_file import load_design
    from spheredrive.io.motion_file import load_motion
    from spheredrive.report import write_report

    loaded = load_design(design)
    asked = None if motion is None else load_motion(motion, wheel_count=loaded.wheel_count)
    print(write_report(loaded, output, motion=asked))
    return 0 if work_out(loaded).works else EXIT_DOES_NOT_WORK


@app.command
def demo(
    name: str = "atlas-dual-race",
    *,
    output: Annotated[Path, Parameter(name=["-o", "--output"])] = Path("spheredrive-demo.html"),
    browser: bool = True,
) -> int:
    """Write the report of a shipped design, by default the dual-race Atlas driven through Table 2.1, and open it.

    Parameters
    ----------
    name
        A shipped design: atlas-dual-race, atlas-demonstrator, atlas-mecanum, orthogonal, collinear-triple-race,
        six-orthogonal or ballbot.
    output
        The HTML file to write.
    browser
        Open the report where there is a screen.
    """
    from spheredrive.designs import design_path, motion_path
    from spheredrive.io.design_file import load_design
    from spheredrive.io.motion_file import load_motion
    from spheredrive.report import write_report

    design = load_design(design_path(name))
    motion = None
    if design.wheel_count == 3:
        motion = load_motion(motion_path("atlas-table-2-1"), wheel_count=3)
    else:
        _note("The demonstration motion is for three wheels; the report is of the design alone.")
    path = write_report(design, output, motion=motion).resolve()
    print(path)
    if browser and not _opened(path):
        _note("No browser was found: open the file above in one.")
    return 0


@app.command
def new(file: Path) -> int:
    """Write a commented design file to start from.

    Parameters
    ----------
    file
        The file to write; one that exists is left alone.
    """
    from spheredrive.io.template import write_new

    write_new(file)
    print(file)
    return 0


@app.command
def schema() -> int:
    """Print the JSON Schema of design files."""
    from spheredrive.io.schema import design_schema

    _print_json(design_schema())
    return 0


def main(arguments: list[str] | None = None) -> None:
    """Run a command line and leave with its exit code; every refusal is a sentence on standard error."""
    for stream in (sys.stdout, sys.stderr):
        # Formulas and the file's own words must not break a terminal that knows less than UTF-8.
        stream.reconfigure(errors="replace")  # type: ignore[union-attr]
    try:
        code = app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
    except CycloptsError as error:
        _refuse(_one_paragraph(str(error)))
    except SpheredriveError as error:
        _refuse(str(error))
    except BrokenPipeError:
        # The reader has gone, as `| head` does: nothing is left to say, and closing the stream must not complain.
        sys.stderr.close()
        code = 0
    except KeyboardInterrupt:
        _note("Stopped.")
        code = 130
    sys.exit(code if isinstance(code, int) else 0)


def _refuse(sentence: str) -> None:
    print(f"spheredrive: {sentence}", file=sys.stderr)
    sys.exit(EXIT_BAD_INPUT)


def _note(sentence: str) -> None:
    print(sentence, file=sys.stderr)


def _one_paragraph(text: str) -> str:
    return " ".join(text.split())


def _print_json(value: object) -> None:
    import json

    print(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False))


def _opened(path: Path) -> bool:
    """Show the page in a browser; a machine without a screen has none to ask."""
    import os
    import webbrowser

    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return False
    return webbrowser.open(path.as_uri())
