"""The rules of docs/architecture.md that a machine can hold: who may import whom, and what must not be loaded early."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2] / "src" / "spheredrive"

# From the bottom up, as in docs/architecture.md: a module imports its own layer and those before it.
LAYERS = [
    ("errors",),
    ("values", "frames", "compiled"),
    ("wheels",),
    ("design", "motion"),
    ("shape",),
    ("kinematics",),
    ("contact",),
    ("checking",),
    ("dynamics",),
    ("vibration",),
    ("simulation",),
    ("summary", "scene"),
    ("io", "designs"),
    ("report",),
    ("studies", "export"),
    ("app",),
    ("cli",),
]
# A value that can describe itself: ``Design.__str__`` asks for its table when it is printed.
EXCEPTIONS = {("design", "summary")}
PHYSICS = {
    "values",
    "frames",
    "wheels",
    "design",
    "motion",
    "kinematics",
    "contact",
    "checking",
    "dynamics",
    "shape",
    "vibration",
}
EDGE_LIBRARIES = {"pydantic", "pint", "tomllib", "tomlkit", "matplotlib", "jinja2", "cyclopts", "rich", "xarray"}


def modules():
    return sorted(p for p in SOURCE.rglob("*.py") if p.name not in ("__main__.py",) and p != SOURCE / "__init__.py")


def layer_name(path: Path) -> str:
    return path.relative_to(SOURCE).parts[0].removesuffix(".py")


def imports(path: Path) -> set[str]:
    """Dotted names a file imports at run time, wherever they stand."""
    found = set()
    for node in ast.walk(_without_type_checking(ast.parse(path.read_text(encoding="utf-8")))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def _without_type_checking(tree: ast.Module) -> ast.Module:
    tree.body = [
        node
        for node in tree.body
        if not (isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING")
    ]
    return tree


def rank(name: str) -> int:
    return next(i for i, layer in enumerate(LAYERS) if name in layer)


@pytest.mark.parametrize("path", modules(), ids=lambda p: str(p.relative_to(SOURCE)))
def test_imports_run_downward_only(path):
    here = layer_name(path)
    for name in imports(path):
        parts = name.split(".")
        if parts[0] != "spheredrive" or len(parts) == 1 or not any(parts[1] in layer for layer in LAYERS):
            continue
        assert rank(parts[1]) <= rank(here) or (here, parts[1]) in EXCEPTIONS, f"{here} imports {name}"


@pytest.mark.parametrize("path", modules(), ids=lambda p: str(p.relative_to(SOURCE)))
def test_physics_imports_no_edge_library(path):
    if layer_name(path) in PHYSICS:
        assert not {name.split(".")[0] for name in imports(path)} & EDGE_LIBRARIES


def test_every_module_has_its_layer():
    assert {layer_name(path) for path in modules()} == {name for layer in LAYERS for name in layer}


@pytest.mark.parametrize("path", modules(), ids=lambda p: str(p.relative_to(SOURCE)))
def test_every_module_says_what_it_is(path):
    assert ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))


def test_import_of_the_package_loads_no_library():
    libraries = ("numpy", "numba", "pydantic", "matplotlib", "xarray")
    code = f"import sys, spheredrive; print([m for m in {libraries} if m in sys.modules])"
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert answer.stdout.strip() == "[]"


def test_command_line_loads_no_library_before_it_knows_the_command():
    libraries = ("numpy", "numba", "pint", "matplotlib", "xarray")
    code = f"import sys, spheredrive.cli; print([m for m in {libraries} if m in sys.modules])"
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert answer.stdout.strip() == "[]"
