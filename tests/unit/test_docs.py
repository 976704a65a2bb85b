"""The documentation says what is true: names, commands, files and numbers in it are those of the program."""

import dataclasses
import importlib
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

import spheredrive as sd
from spheredrive.cli import app, main

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [*DOCS.glob("*.md"), *DOCS.glob("python/*.md"), *DOCS.glob("thesis/*.md")]
TEXT = {path: path.read_text(encoding="utf-8") for path in PAGES}
START, THEORY, FILES = (TEXT[DOCS / f"{name}.md"] for name in ("start", "theory", "files"))

# What a page loads, as against what it links to.
LOADED = re.compile(r"""<(?:script|img|iframe|source)[^>]*\ssrc=["']?(?:https?:)?//|<link[^>]*\shref=["']?(?:https?:)?//""")


@pytest.fixture
def extension(monkeypatch):
    """A module of the site's own extensions, by name."""
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    return importlib.import_module


def found(name: str):
    """What ``name`` is below the package: a module, and from there on attributes or declared fields."""
    value, parts = sd, name.split(".")
    while parts:
        part = parts.pop(0)
        fields = getattr(value, "__dataclass_fields__", {})
        if part in fields and not hasattr(value, part):
            assert not parts, f"{name}: {part} is a field and has nothing below it"
            return fields[part]
        value = getattr(value, part)
    return value


def blocks(text: str, language: str) -> list[str]:
    """Code of a language in a page, whatever options stand above it."""
    found = re.findall(rf"```(?:\{{code-block\}} )?{language}\n((?::\w+:[^\n]*\n)*)\n?(.*?)```", text, re.S)
    return [code for _, code in found]


def lacking(names) -> list[str]:
    """Names that are not there."""
    gone = []
    for name in names:
        try:
            found(name)
        except AttributeError:
            gone.append(name)
    return gone


def test_symbols_are_called_in_the_code_what_the_table_says():
    table = THEORY.split("## Symbols")[1]
    names = [name for row in table.splitlines() if row.startswith("| $") for name in re.findall(r"`([\w.]+)`", row)]
    assert len(names) > 60
    assert not lacking(names)


def test_names_of_the_package_in_the_pages_exist():
    names = {name.rstrip(".") for text in TEXT.values() for name in re.findall(r"(?<![\w.])sd\.([a-z_]\w*(?:\.\w+)*)", text)}
    assert len(names) > 25
    assert not lacking(sorted(names))


def test_modules_of_the_reference_and_their_functions_exist():
    directive = re.compile(r"\.\. auto(module|function):: spheredrive\.([\w.]+)")
    directives = [hit for text in TEXT.values() for hit in directive.findall(text)]
    assert len(directives) > 20
    for kind, name in directives:
        module, _, function = (name, "", "") if kind == "module" else name.rpartition(".")
        value = importlib.import_module(f"spheredrive.{module}")
        assert kind == "module" or callable(getattr(value, function)), name


def test_public_modules_are_all_in_the_reference():
    named = " ".join(text for path, text in TEXT.items() if path.parent.name == "python")
    assert not [name for name in sd._MODULES if f"spheredrive.{name}\n" not in named and f"spheredrive.{name}." not in named]


def test_commands_in_the_pages_exist():
    named = {name for text in TEXT.values() for name in re.findall(r"(?:^|`|')spheredrive ([a-z]+)", text, re.M)}
    assert len(named) >= 8
    assert not named - set(app)


def test_start_works_in_the_order_in_which_it_is_written(tmp_path, monkeypatch, capsys):
    """Every command and the Python of the page, one after the other, and the numbers it shows."""
    monkeypatch.chdir(tmp_path)
    (motion,), (python,), (shown,) = (blocks(START, language) for language in ("toml", "python", "text"))
    Path("motion.toml").write_text(motion, encoding="utf-8")
    commands = [shlex.split(line) for block in blocks(START, "sh") for line in block.splitlines() if "pip" not in line]
    assert [command[1] for command in commands] == ["new", "check", "simulate", "vibration", "report", "view"]
    for program, name, *arguments in commands:
        assert program == "spheredrive"
        if name == "view":
            # It would stay open; its page has tests of its own.
            app.parse_args([name, *arguments], exit_on_error=False, print_error=False)
            continue
        with pytest.raises(SystemExit) as left:
            main([name, *arguments])
        said = capsys.readouterr()
        assert left.value.code == 0, (name, said.err)
        if name == "check":
            assert shown.rstrip() in said.out
    assert Path("report.html").stat().st_size > 10_000
    exec(compile(python, "start.md", "exec"), {})
    assert capsys.readouterr().out


def test_extras_in_the_pages_are_those_of_the_package():
    import tomllib

    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    named = {name for text in TEXT.values() for name in re.findall(r'pip install "[.\w]*\[(\w+)\]"', text)}
    assert named and not named - set(extras)


def test_files_in_the_pages_are_read(tmp_path):
    from spheredrive.io import parse_motion, starting_file
    from spheredrive.io.study_file import parse_study
    from spheredrive.studies.sweep.metrics import metrics

    motion, study = blocks(FILES, "toml")
    assert parse_motion(motion).kind == "wheel-torque"
    (tmp_path / "machine.toml").write_text(starting_file(), encoding="utf-8")
    assert len(parse_study(study, metrics(), folder=tmp_path).parameters) == 2


def exists(page: Path, target: str) -> bool:
    """Whether a page or file that ``page`` names is there; pages of the gallery come from the examples."""
    path = Path(os.path.normpath(page.parent / target))
    if path.parent == DOCS / "gallery":
        return path.stem == "index" or (ROOT / "examples" / f"{path.stem}.py").exists()
    return path.exists()


def test_links_and_files_of_the_pages_are_there():
    for page, text in TEXT.items():
        links = [link for link in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", text) if "://" not in link]
        links += [f"gallery/{name}.rst" for name in re.findall(r"\]\(#sphx_glr_gallery_(\w+)\.py\)", text)]
        files = re.findall(r"\{(?:image|literalinclude|figure)\} (\S+)", text)
        trees = [entry for tree in re.findall(r"```\{toctree\}\n(.*?)```", text, re.S) for entry in tree.split("\n")]
        entries = [re.sub(r".*<(.*)>", r"\1", entry) for entry in trees if entry and not entry.startswith(":")]
        pages = [e if exists(page, e) or e.startswith("gallery/") else f"{e}.md" for e in entries]
        for target in [*links, *files, *pages]:
            assert exists(page, target), f"{page.name}: {target}"


def test_pages_load_nothing_from_outside():
    own = [DOCS / "conf.py", *DOCS.glob("_static/*"), *DOCS.glob("_templates/*"), *DOCS.glob("_ext/*.py")]
    for path in own:
        assert not re.search(r"(https?:)?//\w+\.\w", path.read_text(encoding="utf-8")), path.name
    for path, text in TEXT.items():
        assert not LOADED.search(text) and not re.search(r"!\[[^\]]*\]\(https?:", text), path.name
    # MathJax comes from a package: with sphinx.ext.mathjax alone pages would fetch it.
    assert '"sphinx-mathjax-offline"' in (DOCS / "conf.py").read_text(encoding="utf-8")
    assert "intersphinx" not in (DOCS / "conf.py").read_text(encoding="utf-8")


def test_gallery_has_a_place_for_every_example(extension):
    assert set(extension("gallery_style").EXAMPLES) == {path.stem for path in (ROOT / "examples").glob("*.py")}


def test_command_page_explains_every_word_of_every_command(extension):
    pytest.importorskip("sphinx")
    commands = extension("commands")
    assert set(commands.command_names()) == {name for name in app if not name.startswith("-")}
    for name in commands.command_names():
        page = commands.command_page(name)
        assert page.startswith(f"## {name}\n\n") and f"spheredrive {name}" in page
        assert "\n: —" not in page, f"{name} has a word without an explanation"
        assert "Parameters" not in page


def test_docstring_becomes_what_sphinx_reads(extension):
    words = extension("docstrings")
    assert words.escaped("|Ω| of ``a*b`` and x_ * y_") == r"\|Ω\| of ``a*b`` and x\_ \* y\_"
    formula = ["    a = b *c*", "      + d", ""]
    table = ["time   t, s", "a, b   both,", "       of |x|", ""]
    entries = ["``time``", "    t, s", "``a``, ``b``", "    both,", r"    of \|x\|", ""]
    lines = words.formatted(["One *line*.", "", *formula, *table, "The end."])
    assert lines == [r"One \*line\*.", "", "::", "", *formula, *entries, "The end.", ""]


def test_declared_fields_have_unit_and_meaning(extension):
    from spheredrive.design import Contact

    lines = extension("docstrings").declared_fields(Contact)
    names = [field.name for field in dataclasses.fields(Contact)]
    assert lines[::2] == [f"``{name}``" for name in names]
    assert lines[1].endswith("N/m") and lines[3].endswith("``0.0`` if absent")


@pytest.mark.long
def test_site_builds_without_a_warning_and_asks_nobody(tmp_path):
    pytest.importorskip("sphinx_gallery")
    import shutil

    left_out = shutil.ignore_patterns("_build", "gallery", "__pycache__")
    shutil.copytree(DOCS, tmp_path / "docs", ignore=left_out)
    shutil.copytree(ROOT / "examples", tmp_path / "examples", ignore=left_out)
    (tmp_path / "src").symlink_to(ROOT / "src")
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html", "docs", "html"]
    answer = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False)
    assert answer.returncode == 0, answer.stderr
    pages = list((tmp_path / "html").rglob("*.html"))
    assert len(pages) > 30
    for page in pages:
        assert not LOADED.search(page.read_text(encoding="utf-8")), page.name
    for sheet in (tmp_path / "html" / "_static").rglob("*.css"):
        assert not re.search(r"(?:url\(|@import)\s*['\"]?(?:https?:)?//", sheet.read_text(encoding="utf-8")), sheet.name
