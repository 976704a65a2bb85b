"""The app and the scene compute no physics: they call what others may call as well, by public names."""

import ast
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2] / "src" / "spheredrive"
FILES = sorted([*(SOURCE / "app").rglob("*.py"), *(SOURCE / "scene").rglob("*.py")])
# Only here are formulas of the machine asked for; all else draws what these have found.
ASKING = {"app/answers.py", "app/player.py", "app/session.py", "scene/bodies.py", "scene/track.py"}
ROOMS = {"kinematics", "checking", "shape"}
ENGINES = {"dynamics", "vibration", "simulation", "contact"}
# Solving for anything is an answer, and answers have one place each.
SOLVERS = {"svd", "pinv", "inv", "solve", "lstsq", "eig", "eigh", "eigvals", "eigvalsh", "det", "qr", "expm", "solve_ivp"}


def imported(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(SOURCE)))
def test_only_public_names_are_imported(path):
    names = {name for name in imported(path) if name.startswith("spheredrive.")}
    assert not {name for name in names if any(part.startswith("_") for part in name.split("."))}


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(SOURCE)))
def test_formulas_are_asked_for_in_few_places_and_solved_in_none(path):
    rooms = {name.split(".")[1] for name in imported(path) if name.startswith("spheredrive.")}
    rooms |= {name.split(".")[1] for name in imported(path) if name in {f"spheredrive.{room}" for room in ROOMS | ENGINES}}
    assert not rooms & ENGINES
    if path.relative_to(SOURCE).as_posix() not in ASKING:
        # A finding is a value that is shown, not a formula.
        assert not (rooms & ROOMS) - {"checking" if path.name == "words.py" else ""}
    tree = ast.parse(path.read_text(encoding="utf-8"))
    called = {node.func.attr for node in ast.walk(tree) if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)}
    assert not called & SOLVERS
    assert not {name.split(".")[0] for name in imported(path)} & {"scipy", "numba"}


def test_only_the_server_knows_how_viser_is_made():
    private = {p.relative_to(SOURCE).as_posix() for p in FILES for name in imported(p) if "viser" in name and "._" in name}
    assert private == {"app/server.py"}


def test_the_scene_needs_no_viser():
    assert not [p.name for p in (SOURCE / "scene").rglob("*.py") for name in imported(p) if name.startswith("viser")]
