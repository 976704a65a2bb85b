"""The command line: one function a subcommand, each a thin edge over the functions it calls.

Results go to standard output, progress and notes to standard error. Exit 0: done; 1: done, and the findings say the design
does not work; 2: bad input, or an output that cannot be written; 70: a defect of this program; 130: stopped. Imports stand
inside the functions: a help text must not wait for a compiler.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TextIO

from cyclopts import App, CycloptsError, Parameter

import spheredrive
from spheredrive.errors import SpheredriveError

if TYPE_CHECKING:
    from spheredrive.design import Design
    from spheredrive.motion import Motion

EXIT_DOES_NOT_WORK = 1
EXIT_BAD_INPUT = 2
EXIT_DEFECT = 70
EXIT_STOPPED = 130

# Work that is done sooner than this, in s, shows no progress.
PATIENCE = 1.0

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
def simulate(
    design: Path,
    motion: Path,
    *,
    output: Annotated[Path, Parameter(name=["-o", "--output"])] = Path("run.nc"),
    model: str = "rolling",
    json: Json = False,
) -> int:
    """Run a motion through the dynamics and write everything over time into one NetCDF file.

    Parameters
    ----------
    design
        Design file (TOML).
    motion
        Motion file (TOML).
    output
        The NetCDF file to write.
    model
        Model of the machine: rolling, or compliant: every roller a contact that gives way, slips and opens.
    """
    from spheredrive.io.design_file import load_design
    from spheredrive.io.files import require_no_input
    from spheredrive.io.motion_file import load_motion
    from spheredrive.io.results import require_writable, write_run
    from spheredrive.simulation.overview import overview
    from spheredrive.simulation.simulate import simulate_run

    loaded = load_design(design)
    asked = load_motion(motion, wheel_count=loaded.wheel_count)
    require_no_input(output, _inputs((design, loaded), (motion, asked)))
    require_writable(output)
    try:
        with _progress("Simulating") as watch:
            run, dataset = simulate_run(loaded, asked, model, watch=watch)
        if model == "compliant":
            from spheredrive.simulation.compliant.overview import compliant_overview

            result = compliant_overview(loaded, run)
        else:
            result = overview(loaded, run, model)
        write_run(dataset, output)
    except KeyboardInterrupt:
        _note(f"Stopped: {output} is not written.")
        return EXIT_STOPPED
    if json:
        _print_json({"path": str(output), **result.as_dict()})
    else:
        from spheredrive.summary import compliant_text, run_text

        print(f"{output}\n{compliant_text(result) if model == 'compliant' else run_text(result)}")
    return 0 if result.works else EXIT_DOES_NOT_WORK


@app.command
def vibration(
    design: Path,
    *,
    speeds: Annotated[str, Parameter(name="--speeds", allow_leading_hyphen=True)],
    model: str = "coupled",
    payload: str | None = None,
    isolator: str | None = None,
    isolator_damping: float | None = None,
    wanted: str | None = None,
    json: Json = False,
) -> int:
    """Say how the wheels' rollers shake the sphere and its payload at constant wheel speeds.

    Parameters
    ----------
    design
        Design file (TOML).
    speeds
        One speed a wheel with their unit, such as "0.1 1.2 0.9 rad/s", or one for all, such as "30 rpm".
    model
        Model of the machine: coupled, or independent for the thesis's.
    payload
        Mass of a payload inside the sphere, a part of sphere.mass, such as "80 kg".
    isolator
        Natural frequency of the isolator that carries the payload, such as "3 Hz".
    isolator_damping
        Damping ratio of the isolator; 0.1 if absent.
    wanted
        Instead of --isolator: RMS acceleration that the payload may have, such as "0.3 m/s^2"; the stiffest isolator is sought.
    """
    from spheredrive.io.design_file import load_design
    from spheredrive.io.speeds import parse_isolation, parse_speeds
    from spheredrive.summary import vibration_text
    from spheredrive.vibration.assessment.as_dict import isolator_dict
    from spheredrive.vibration.assessment.assess import assess

    loaded = load_design(design)
    _warn_of_compiling()
    wheel_speed = parse_speeds(speeds, loaded.wheel_count)
    springs, chosen = parse_isolation(loaded, wheel_speed, payload, isolator, isolator_damping, wanted)
    result = assess(loaded, wheel_speed, model, isolator=springs)
    if json:
        _print_json({**result.as_dict(), "isolator_sought": None if chosen is None else isolator_dict(chosen)})
    else:
        print(vibration_text(result, chosen))
    return 0 if result.works else EXIT_DOES_NOT_WORK


@app.command
def compare(
    *designs: Path,
    wheel: Annotated[list[str] | None, Parameter(name="--wheel", consume_multiple=True)] = None,
    speeds: Annotated[str | None, Parameter(name="--speeds", allow_leading_hyphen=True)] = None,
    motion: Path | None = None,
    output: Annotated[Path | None, Parameter(name=["-o", "--output"])] = None,
    json: Json = False,
) -> int:
    """Set several designs side by side, or one design with the wheels of several parts of the catalogue.

    Parameters
    ----------
    designs
        Design files (TOML).
    wheel
        Parts of the catalogue, maker/part: the first design with its wheels replaced by each of them.
    speeds
        Wheel speeds of the first design, such as "0.1 1.2 0.9 rad/s"; the others move their sphere's surface alike. 1 rad/s
        if absent.
    motion
        Motion file (TOML) of the first design, for the preload that keeps contacts from slipping in it.
    output
        An HTML page to write, with figures.
    """
    from spheredrive.io.design_file import load_design
    from spheredrive.io.files import require_no_input, write_whole
    from spheredrive.io.motion_file import load_motion
    from spheredrive.io.speeds import parse_speeds
    from spheredrive.studies.compare import compare as work_out
    from spheredrive.studies.compare import machines
    from spheredrive.studies.compare.text import comparison_text

    _warn_of_compiling()
    if not designs:
        raise SpheredriveError("there is nothing to compare: name design files, or one and --wheel with parts of the catalogue")
    loaded = [load_design(design) for design in designs]
    first = loaded[0]
    wheel_speed = None if speeds is None else parse_speeds(speeds, first.wheel_count)
    asked = None if motion is None else load_motion(motion, wheel_count=first.wheel_count)
    if output is not None:
        require_no_input(output, _inputs(*zip(designs, loaded, strict=True), (motion, asked)))
    chosen = machines(dict(zip(map(str, designs), loaded, strict=True)), wheel or [])
    result = work_out(chosen, wheel_speed, asked)
    if output is not None:
        from spheredrive.studies.compare.page import comparison_page

        write_whole(output, comparison_page(result))
    if json:
        _print_json({"path": None if output is None else str(output), **result.as_dict()})
    else:
        print(*([output] if output else []), comparison_text(result), sep="\n")
    return 0 if result.works else EXIT_DOES_NOT_WORK


@app.command
def report(
    design: Path,
    motion: Path | None = None,
    *,
    speeds: Annotated[str | None, Parameter(name="--speeds", allow_leading_hyphen=True)] = None,
    output: Annotated[Path, Parameter(name=["-o", "--output"])] = Path("report.html"),
) -> int:
    """Write everything about a design into one HTML file.

    Parameters
    ----------
    design
        Design file (TOML).
    motion
        Motion file (TOML), for what changes over time.
    speeds
        Constant wheel speeds for the vibration, such as "0.1 1.2 0.9 rad/s"; the mean speeds of the motion if absent.
    output
        The HTML file to write.
    """
    from spheredrive.io.design_file import load_design
    from spheredrive.io.files import require_no_input
    from spheredrive.io.motion_file import load_motion

    loaded = load_design(design)
    asked = None if motion is None else load_motion(motion, wheel_count=loaded.wheel_count)
    wheel_speed = None
    if speeds is not None:
        from spheredrive.io.speeds import parse_speeds

        wheel_speed = parse_speeds(speeds, loaded.wheel_count)
    require_no_input(output, _inputs((design, loaded), (motion, asked)))
    works = _write_report(loaded, asked, output, wheel_speed)
    print(output)
    return 0 if works else EXIT_DOES_NOT_WORK


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
    from spheredrive.io.files import require_no_input
    from spheredrive.io.motion_file import load_motion

    design = design_path(name)
    loaded = load_design(design)
    motion = motion_path("atlas-table-2-1") if loaded.wheel_count == 3 else None
    asked = None if motion is None else load_motion(motion, wheel_count=3)
    require_no_input(output, _inputs((design, loaded), (motion, asked)))
    if motion is None:
        _note("The demonstration motion is for three wheels; the report is of the design alone.")
    works = _write_report(loaded, asked, output)
    path = output.resolve()
    print(path)
    if browser and not _opened(path):
        _note("No browser was found: open the file above in one.")
    return 0 if works else EXIT_DOES_NOT_WORK


@app.command
def export(
    format: str,
    design: Path,
    *,
    output: Annotated[Path, Parameter(name=["-o", "--output"])],
    check: Path | None = None,
    json: Json = False,
) -> int:
    """Write the machine for another program, and say how far that program's answer is from ours.

    Parameters
    ----------
    format
        Format of the file: mjcf, a MuJoCo model with every roller on its own hinge.
    design
        Design file (TOML).
    output
        The file to write.
    check
        Motion file (TOML): run it in both programs and compare.
    """
    from spheredrive.export.command import check_motion, check_text
    from spheredrive.export.command import export as write
    from spheredrive.io.design_file import load_design
    from spheredrive.io.files import require_no_input
    from spheredrive.io.motion_file import load_motion

    loaded = load_design(design)
    asked = None if check is None else load_motion(check, wheel_count=loaded.wheel_count)
    require_no_input(output, _inputs((design, loaded), *([] if asked is None else [(check, asked)])))
    write(format, loaded, output)
    if asked is None:
        if json:
            _print_json({"path": str(output)})
        else:
            print(output)
        return 0
    try:
        with _progress("Running both engines") as watch:
            result = check_motion(loaded, asked, watch=watch)
    except KeyboardInterrupt:
        _note(f"Stopped: {output} is written, the engines are not compared.")
        return EXIT_STOPPED
    if json:
        _print_json({"path": str(output), **result.as_dict()})
    else:
        print(f"{output}\n{check_text(result)}")
    return 0 if result.works else EXIT_DOES_NOT_WORK


@app.command
def sweep(
    study: Path,
    *,
    output: Annotated[Path, Parameter(name=["-o", "--output"])],
    workers: int | None = None,
    dask: str | None = None,
    json: Json = False,
) -> int:
    """Work out every point of a study and write tables and figures; the same command goes on where it was stopped.

    Parameters
    ----------
    study
        Study file (TOML).
    output
        The folder to write: result.nc, result.parquet and figures.
    workers
        Processes; one a core if absent, 0 for none but this one.
    dask
        Address of a running Dask scheduler, such as tcp://host:8786, instead of processes here.
    """
    from spheredrive.studies.sweep.command import Stopped, sweep_command

    try:
        result = sweep_command(study, output, workers, dask)
    except Stopped as stop:
        _note(str(stop))
        return EXIT_STOPPED
    for note in result.notes:
        _note(note)
    if json:
        _print_json(result.as_dict())
    else:
        print(result.text())
    return 0 if result.works else EXIT_DOES_NOT_WORK


@app.command
def optimize(
    study: Path,
    *,
    output: Annotated[Path, Parameter(name=["-o", "--output"])],
    workers: int | None = None,
    dask: str | None = None,
    json: Json = False,
) -> int:
    """Search the best designs for several goals at once; the same command goes on where it was stopped.

    Parameters
    ----------
    study
        Study file (TOML) with objectives.
    output
        The folder to write: tables, figures and design files of the best.
    workers
        Processes; one a core if absent, 0 for none but this one.
    dask
        Address of a running Dask scheduler, such as tcp://host:8786, instead of processes here.
    """
    from spheredrive.studies.optimize.command import Stopped, optimize_command

    try:
        with _progress("Optimising") as watch:
            result = optimize_command(study, output, workers, dask, watch)
    except Stopped as stop:
        _note(str(stop))
        return EXIT_STOPPED
    for note in result.notes:
        _note(note)
    if json:
        _print_json(result.as_dict())
    else:
        print(result.text())
    return 0 if result.works else EXIT_DOES_NOT_WORK


@app.command
def sensitivity(study: Path, *, points: int | None = None, json: Json = False) -> int:
    """Say how a study's metrics change with its parameters.

    Parameters
    ----------
    study
        Study file (TOML).
    points
        Work out Sobol indices over the parameters' distributions from so many points, instead of derivatives at the design.
    """
    from spheredrive.studies.sensitivity.command import sensitivity_command

    result = sensitivity_command(study, points)
    if json:
        _print_json(result.as_dict())
    else:
        print(result.text())
    return 0


@app.command
def ensemble(
    design: Path,
    motion: Path,
    *,
    output: Annotated[Path, Parameter(name=["-o", "--output"])],
    count: int = 100,
    seed: int = 1,
    friction_spread: float = 0.0,
    alignment_spread: str | None = None,
    radius_spread: float = 0.0,
    wear: str | None = None,
    device: str = "cpu",
    json: Json = False,
) -> int:
    """Run machines as they are really made through the compliant model: how far do they scatter?

    Parameters
    ----------
    design
        Design file (TOML).
    motion
        Motion file (TOML).
    output
        The folder to write: ensemble.nc and a figure.
    count
        Number of machines.
    seed
        Seed of the scatter; the same seed gives the same machines.
    friction_spread
        Relative standard deviation of the friction, such as 0.1.
    alignment_spread
        Standard deviation of each wheel's rotation about each axis, such as "0.2 deg".
    radius_spread
        Relative standard deviation of each wheel's radius.
    wear
        Scale of the wear of each wheel's rollers, such as "0.1 mm".
    device
        Where the runs go: cpu, gpu, or auto, which takes a graphics card where there is one.
    """
    from spheredrive.io.design_file import load_design
    from spheredrive.io.motion_file import load_motion
    from spheredrive.simulation.compliant.gpu import device_of
    from spheredrive.studies.ensemble.command import ensemble_command, spread_of

    chosen, note = device_of(device)
    if note:
        _note(note)
    loaded = load_design(design)
    asked = load_motion(motion, wheel_count=loaded.wheel_count)
    spread = spread_of(friction_spread, alignment_spread, radius_spread, wear)
    _warn_of_compiling()
    try:
        with _progress("Running the ensemble") as watch:
            result = ensemble_command(loaded, asked, output, spread, count, seed, watch, chosen)
    except KeyboardInterrupt:
        _note(f"Stopped: what is finished is kept in {output}; the same command goes on there.")
        return EXIT_STOPPED
    if json:
        _print_json(result.as_dict())
    else:
        print(result.text())
    return 0 if result.works else EXIT_DOES_NOT_WORK


@app.command
def view(
    design: Path,
    run: Path | None = None,
    *,
    port: int | None = None,
    browser: bool = True,
    address: str = "127.0.0.1",
) -> int:
    """Open the machine in a browser page: sliders, Jacobian, findings, and a run played back.

    Parameters
    ----------
    design
        Design file (TOML), or the folder of a sweep or an optimization.
    run
        Run of simulate (NetCDF), or the folder of a sweep or an optimization.
    port
        Port to listen on; the first free one from 8080 if absent.
    browser
        Open the page where there is a screen.
    address
        Address to listen on; any but this machine's own takes the token that is printed.
    """
    from spheredrive.app.command import view as show

    return show(design, run, port, browser, address)


@app.command
def reproduce(
    *,
    output: Annotated[Path, Parameter(name=["-o", "--output"])] = Path("reproduction"),
    json: Json = False,
) -> int:
    """Rebuild every figure, table and number of the thesis into one folder, and say which agree.

    Parameters
    ----------
    output
        The folder to write: index.html, and an SVG and a CSV for every figure.
    """
    from spheredrive.studies.reproduce import reproduce as rebuild

    with _progress("Rebuilding the thesis") as watch:
        result = rebuild(output, watch)
    if json:
        _print_json([row.as_dict() for row in result.rows])
    else:
        print(result.files[0])
        agree = sum(row.agrees for row in result.rows)
        print(f"{len(result.rows)} claims: {agree} agree, {len(result.rows) - agree} differ")
    return 0


@app.command
def catalogue(
    *words: str,
    wheel_type: Annotated[str | None, Parameter(name="--type")] = None,
    maker: str | None = None,
    diameter: str | None = None,
    rollers: str | None = None,
    json: Json = False,
) -> int:
    """List real wheels that can be bought, with what is published of them; or show one with the source of each figure.

    Parameters
    ----------
    words
        A part, maker/part, to show whole; or words to look for in names and notes.
    wheel_type
        Wheel type: standard, dual-race, mecanum ...
    maker
        Maker, such as nexus.
    diameter
        Diameter from and to, such as "40..110 mm", "40 mm.." or "100 mm".
    rollers
        Number of rollers from and to, such as 8..12.
    """
    from spheredrive.io.catalogue import parse_range, part, parts

    asked = " ".join(words)
    if "/" in asked:
        if any((wheel_type, maker, diameter, rollers)):
            raise SpheredriveError(f"{asked} names one part, which is shown whole; leave out the filters")
        chosen = part(asked)
        if json:
            _print_json(chosen.as_dict())
        else:
            from spheredrive.io.catalogue_text import part_text

            print(part_text(chosen))
        return 0
    size = None if diameter is None else parse_range(diameter, "m", "diameter")
    count = None if rollers is None else parse_range(rollers, "", "rollers")
    found = parts(wheel_type=wheel_type, maker=maker, diameter=size, rollers=count, text=asked)
    if json:
        _print_json([entry.as_dict() for entry in found])
    else:
        from spheredrive.io.catalogue_text import parts_text

        print(parts_text(found))
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
    _settle_streams()
    try:
        code = _answer(arguments)
        sys.stdout.flush()
    except BrokenPipeError:
        # The reader has gone, as `| head` does: nothing is left to say.
        _abandon(sys.stdout)
        code = 0
    except OSError as error:
        _abandon(sys.stdout)
        code = _refuse(f"the output cannot be written: {(error.strerror or str(error)).lower()}")
    except KeyboardInterrupt:
        _note("Stopped.")
        code = EXIT_STOPPED
    try:
        sys.stderr.flush()
    except OSError:
        _abandon(sys.stderr)
    sys.exit(code)


def _answer(arguments: list[str] | None) -> int:
    """The exit code of a command line. Raises ``OSError`` where standard output cannot be written."""
    try:
        code = app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
    except CycloptsError as error:
        return _refuse(_one_paragraph(str(error)))
    except SpheredriveError as error:
        return _refuse(str(error))
    except SystemExit as error:
        # How rich, which prints the help, leaves when its reader has gone.
        if isinstance(error.__context__, BrokenPipeError):
            raise error.__context__ from None
        raise
    except Exception as error:
        # Streams have no file name; what befalls a file is a SpheredriveError, or else nobody has thought of it.
        if isinstance(error, OSError) and error.errno is not None and error.filename is None:
            raise
        return _admit(error)
    return code if isinstance(code, int) else 0


def _settle_streams() -> None:
    # In this order: each takes the lowest free number, its own, which no file opened later must get.
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115 - as long as the process
    for stream in (sys.stdout, sys.stderr):
        # Formulas and the file's own words must not break a terminal that knows less than UTF-8.
        stream.reconfigure(errors="replace")  # type: ignore[union-attr]


def _abandon(stream: TextIO) -> None:
    """Lead ``stream`` nowhere: at its end the interpreter writes what it still holds, and would complain."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _refuse(sentence: str) -> int:
    _note(f"spheredrive: {sentence}")
    return EXIT_BAD_INPUT


def _admit(error: Exception) -> int:
    """Say that this program is at fault: an exit code of 1 would say that the design is."""
    import traceback

    from spheredrive.io.files import printable

    if os.environ.get("SPHEREDRIVE_DEBUG"):
        _note("".join(traceback.format_exception(error)).rstrip())
    what = printable(_one_paragraph(f"{type(error).__name__}: {error}").removesuffix(":"))
    _note(
        f"spheredrive: a defect of spheredrive, not of your input ({what}); please report it with your files and what the "
        "environment variable SPHEREDRIVE_DEBUG=1 shows."
    )
    return EXIT_DEFECT


def _note(sentence: str) -> None:
    # Where nobody can be told, the exit code still tells.
    with suppress(OSError):
        print(sentence, file=sys.stderr)


def _inputs(*read: tuple[Path | None, Design | Motion | None]) -> list[Path]:
    """Every file that was read: those of designs and motions, and the tables that they name."""
    import tomllib

    found = []
    for path, value in read:
        if path is not None and value is not None:
            found += [path, *(path.parent / name for name in _named_files(tomllib.loads(value.source)))]
    return found


def _named_files(table: dict[str, Any]) -> Iterator[str]:
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _named_files(value)
        elif key == "file" and isinstance(value, str):
            yield value


def _write_report(design: Design, motion: Motion | None, output: Path, speeds=None) -> bool:
    """Write the report, and say whether the design works."""
    from spheredrive.io.files import write_whole
    from spheredrive.report.page import page

    _warn_of_compiling()
    found = page(design, motion, speeds)
    write_whole(output, found.html)
    return found.works


@contextmanager
def _progress(what: str) -> Iterator[Callable[[float], None]]:
    """A function to be told the share of work that is done; it draws a bar where somebody watches and work takes long."""
    if not sys.stderr.isatty():
        yield lambda share: None
        return
    import threading

    from rich.console import Console
    from rich.progress import Progress

    bar = Progress(console=Console(stderr=True), transient=True)
    task = bar.add_task(what, total=1.0)
    # By the clock: compiling the equations for the first time takes long before any work is done.
    timer = threading.Timer(PATIENCE, bar.start)
    timer.start()
    try:
        yield lambda share: bar.update(task, completed=share)
    finally:
        timer.cancel()
        timer.join()
        bar.stop()


def _warn_of_compiling() -> None:
    """Tell whoever watches why the first answer takes long."""
    if sys.stderr.isatty():
        from spheredrive.compiled import when_compiling

        when_compiling(lambda: _note("Compiling the equations for this machine; it takes up to a minute, this once."))


def _one_paragraph(text: str) -> str:
    return " ".join(text.split())


def _print_json(value: object) -> None:
    import json

    # In ASCII: a stream of another encoding would lose letters.
    print(json.dumps(value, indent=2, ensure_ascii=True, allow_nan=False))


def _opened(path: Path) -> bool:
    """Show the page in a browser; a machine without a screen has none to ask."""
    import webbrowser

    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return False
    return webbrowser.open(path.as_uri())
