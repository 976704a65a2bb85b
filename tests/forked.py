"""The command line in processes forked from one that has read the libraries: as a user runs it, without the wait."""

import multiprocessing
import os
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import NamedTuple

PROGRAM = Path(sys.executable).with_name("spheredrive")
LIBRARIES = ["matplotlib.pyplot", "scipy.optimize", "spheredrive.cli", "spheredrive.report.page", "xarray"]


class Answer(NamedTuple):
    returncode: int
    stdout: str
    stderr: str


def run(*words, folder=None, **environment):
    """Exit code and streams of the program with these words, in ``folder``; with an environment, started from nothing."""
    words = [str(word) for word in words]
    if environment or not hasattr(os, "fork"):
        return subprocess.run(
            [str(PROGRAM), *words],
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
            env={**os.environ, **environment},
        )
    with tempfile.TemporaryDirectory() as streams:
        paths = [os.path.join(streams, name) for name in ("out", "err")]
        process = _server().Process(target=_answer, args=(words, str(folder or os.getcwd()), *paths))
        process.start()
        process.join(120)
        assert process.exitcode is not None, f"{words} takes too long"
        return Answer(process.exitcode, *(Path(path).read_text(encoding="utf-8") for path in paths))


@cache
def _server():
    server = multiprocessing.get_context("forkserver")
    server.set_forkserver_preload(LIBRARIES)
    return server


def _answer(words, folder, out, err):
    os.chdir(folder)
    for path, number in ((out, 1), (err, 2)):
        os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT, 0o600), number)
    for name in ("stdout", "stderr"):
        setattr(sys, name, open(getattr(sys, name).fileno(), "w", encoding="utf-8", closefd=False))  # noqa: SIM115
    from spheredrive.cli import main

    main(words)
