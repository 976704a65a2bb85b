"""Every example and every command of the README, run as a user would."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import spheredrive as sd

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
STUDY = """
schema_version = 1
design = "machine.toml"
metrics = ["isotropy"]
[parameters]
"placement.elevation" = { from = "-60 deg", to = "-40 deg", count = 3 }
[objectives]
isotropy = "max"
[algorithm]
name = "nsga2"
population = 8
generations = 2
"""
PROGRAM = Path(sys.executable).with_name("spheredrive")
# Commands one after another in one process, which reads its libraries once.
SEVERAL = """
import json, sys
from spheredrive.cli import main
for line in json.loads(sys.argv[1]):
    try:
        main(line)
    except SystemExit as end:
        if end.code:
            sys.exit(f"{' '.join(line)}: exit {end.code}")
"""


def run(command, folder):
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)


def test_readme_python_runs(tmp_path):
    (block,) = re.findall(r"```python\n(.*?)```", README, re.S)
    answer = run([sys.executable, "-c", block], tmp_path)
    assert answer.returncode == 0, answer.stderr
    assert "worst direction" in answer.stdout


def test_readme_commands_run(tmp_path):
    lines = [line.split("#")[0].strip() for line in README.splitlines() if line.startswith("    spheredrive ")]
    assert len(lines) >= 3
    shutil.copy(sd.motion_path("atlas-table-2-1"), tmp_path / "motion.toml")
    (tmp_path / "study.toml").write_text(STUDY, encoding="utf-8")
    # The thesis takes its time, and the page stays open until it is closed: both have tests of their own.
    commands = [shlex.split(line)[1:] for line in lines if " reproduce " not in line and " view " not in line]
    answer = run([sys.executable, "-c", SEVERAL, json.dumps(commands)], tmp_path)
    assert answer.returncode == 0, answer.stderr
    assert (tmp_path / "report.html").stat().st_size > 10_000


def test_readme_error_is_what_a_user_sees(tmp_path):
    """The README shows an error; the same file makes the same words."""
    shown = re.search(r"    machine\.toml:\d+:\d+: .*\n.*\n.*\^", README).group()
    assert run([str(PROGRAM), "new", "machine.toml"], tmp_path).returncode == 0
    path = tmp_path / "machine.toml"
    lines = path.read_text(encoding="utf-8").splitlines()
    number = int(shown.split(":")[1])
    lines[number - 1] = re.sub(r'"[^"]*"', '"25 kg"', lines[number - 1], count=1).split("#")[0].rstrip()
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    answer = run([str(PROGRAM), "check", "machine.toml"], tmp_path)
    assert answer.returncode == 2
    expected = re.sub(r"^    ", "", shown, flags=re.M)
    assert expected.splitlines()[0] in answer.stderr
    assert expected.splitlines()[2].strip() in answer.stderr


def test_make_targets_of_the_readme_exist():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in set(re.findall(r"make ([\w-]+)", README)):
        assert re.search(rf"^{target}:", makefile, re.M), target


def test_relative_links_of_the_documents_lead_somewhere():
    for document in [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md")]:
        for link in re.findall(r"\]\(([^)#]+)\)", document.read_text(encoding="utf-8")):
            if "://" not in link:
                assert os.path.exists(document.parent / link), f"{document.name}: {link}"
