"""The command `reproduce` from end to end, and the rules that its rows, figures and files keep."""

import csv
import json
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from spheredrive.errors import InputError
from spheredrive.studies.reproduce import reproduce
from spheredrive.studies.reproduce.assumptions import ASSUMPTIONS
from spheredrive.studies.reproduce.claims import all_rows, chapter
from spheredrive.studies.reproduce.drawing import Drawing, standalone
from spheredrive.studies.reproduce.errata import ERRATA
from spheredrive.studies.reproduce.table import Row, rounds_to, signed, span

# One file a figure.
FIGURES = ["fig-2.7", *(f"fig-3.{n}" for n in range(3, 14)), *(f"fig-4.{n}" for n in range(4, 19))]
STUDIES = ["friction", "elevation", "heading", "sphere-mass", "stage-mass", "radius-ratio", "wheel-count"]


@pytest.fixture(scope="module")
def rebuilt(tmp_path_factory):
    """The command as a real process, once: its answer and its folder."""
    folder = tmp_path_factory.mktemp("reproduction") / "out"
    answer = subprocess.run(
        [sys.executable, "-m", "spheredrive", "reproduce", "-o", str(folder), "--json"],
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    return answer, folder


def test_command_leaves_by_0_and_prints_rows_alone(rebuilt):
    answer, _ = rebuilt
    assert answer.returncode == 0, answer.stderr
    assert answer.stderr == ""
    rows = json.loads(answer.stdout)
    assert len(rows) > 70
    for row in rows:
        assert list(row) == ["id", "claim", "thesis", "here", "verdict", "why"]
        assert row["verdict"] in ("agrees", "differs")
        assert all(isinstance(value, str) and value for value in row.values())
    assert len({row["id"] for row in rows}) == len(rows)


def test_command_writes_every_figure_as_svg_and_csv(rebuilt):
    _, folder = rebuilt
    keys = FIGURES + [f"study-{name}" for name in STUDIES]
    assert {path.name for path in folder.iterdir()} == {
        "index.html", "rows.json", *(f"{key}{suffix}" for key in keys for suffix in (".svg", ".csv"))
    }  # fmt: skip
    for key in keys:
        root = ElementTree.fromstring((folder / f"{key}.svg").read_text(encoding="utf-8"))
        assert root.tag == "{http://www.w3.org/2000/svg}svg" and float(root.get("width").removesuffix("pt")) > 100
        with (folder / f"{key}.csv").open(encoding="utf-8", newline="") as file:
            header, *rows = csv.reader(file)
        # Every column says its unit, and every line has a cell for every column.
        assert len(header) >= 2 and all(re.search(r"\(.+\)$", name) for name in header), header
        assert len(set(header)) == len(header) and rows and {len(row) for row in rows} == {len(header)}
        assert all(np.isfinite(float(cell)) or cell == "nan" for row in rows for cell in row if cell)


def test_axes_of_every_figure_have_units(rebuilt):
    """Each figure's text holds a unit in brackets for either direction."""
    _, folder = rebuilt
    for key in FIGURES:
        text = "".join(ElementTree.fromstring((folder / f"{key}.svg").read_text(encoding="utf-8")).itertext())
        assert len(re.findall(r"\((s|mm|µm|m|°|–|%|rad/s|Hz|kN/m|mm/s|mm/s²)\)|rad/s \(mm", text)) >= 2, key


def test_page_holds_every_row_figure_assumption_and_erratum(rebuilt):
    answer, folder = rebuilt
    page = (folder / "index.html").read_text(encoding="utf-8")
    ids = re.findall(r'\bid="([^"]+)"', page)
    assert len(ids) == len(set(ids)), "names in the page are unique"
    for row in json.loads(answer.stdout):
        assert f"row-{row['id']}" in ids
    for key in FIGURES + [f"study-{name}" for name in STUDIES]:
        assert key in ids and f'href="{key}.csv"' in page
    targets = re.findall(r'href="#([^"]+)"', page)
    assert set(targets) <= set(ids), set(targets) - set(ids)
    assert "http://" not in page and "https://" not in page, "the page needs nothing from elsewhere"
    assert page.count("<td>") > len(ASSUMPTIONS)
    assert json.loads((folder / "rows.json").read_text(encoding="utf-8")) == json.loads(answer.stdout)


@pytest.mark.long
def test_rows_are_the_same_in_another_process(rebuilt):
    answer, _ = rebuilt
    assert [row.as_dict() for row in all_rows()] == json.loads(answer.stdout)


def test_every_figure_and_table_has_a_row_of_its_name():
    names = {row.id for row in all_rows()}
    assert set(FIGURES) <= names and "table-2.1" in names
    assert {chapter(row) for row in all_rows()} == {2, 3, 4, 5}


def test_every_difference_is_explained_or_said_to_be_open():
    for row in all_rows():
        assert row.rule and (row.agrees or row.erratum in ERRATA or row.open), row.id
        assert row.erratum in ERRATA or not row.erratum, row.id


def test_every_erratum_of_the_model_page_is_shown_by_a_row_or_an_assumption():
    shown = {row.erratum.partition("-")[0] for row in all_rows()} | set(
        re.findall(r"E\d+", " ".join(one.what for one in ASSUMPTIONS))
    )
    assert {f"E{n}" for n in range(1, 10)} <= shown


def test_assumptions_are_named_once_with_value_and_reason():
    names = [one.what for one in ASSUMPTIONS]
    assert len(names) == len(set(names)) and all(one.shown and one.reason for one in ASSUMPTIONS)


@pytest.mark.parametrize(
    ("value", "printed", "could"),
    [
        (3.8499, "3.8", True),
        (3.851, "3.8", False),
        (3.75, "3.8", True),
        (3.749, "3.8", False),
        (0.5204, "0.52", True),
        (3.6, "4", True),
    ],
)
def test_rounds_to_takes_half_a_unit_of_the_last_digit(value, printed, could):
    assert rounds_to(value, printed) is could


def test_why_says_erratum_only_of_a_difference():
    row = Row("fig-1", "c", "t", "h", True, "Rule.", "E1")
    assert (row.verdict, row.why) == ("agrees", "Rule.")
    other = row._replace(agrees=False)
    assert other.verdict == "differs" and other.why == f"Rule. E1: {ERRATA['E1']}"
    assert "No erratum" in other._replace(erratum="").why
    assert other._replace(erratum="", open="x.").why == "Rule. The text alone cannot decide this: x."


def test_numbers_have_true_minus_signs():
    assert (signed(-3.31), signed(3.31), span(0.1, 0.25)) == ("−3.3", "+3.3", "0.100 … 0.250")


def test_csv_leaves_short_columns_blank():
    drawing = Drawing("fig-1", "t", "c", None, {"a (m)": np.array([1.0, -0.0, 1 / 3]), "n (-)": np.array([4])})  # type: ignore[arg-type]
    assert drawing.csv() == "a (m),n (-)\n1,4\n0,\n0.333333333,\n"


def test_standalone_svg_has_namespace_and_size():
    root = ElementTree.fromstring(standalone('<svg viewBox="0 0 30 20.5" role="img"><path d="M 0 0"/></svg>').encode())
    assert (root.tag, root.get("width"), root.get("height")) == ("{http://www.w3.org/2000/svg}svg", "30pt", "20.5pt")


def test_reproduce_refuses_a_file_as_folder(tmp_path):
    path = tmp_path / "taken"
    path.write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match="is a file; name a folder"):
        reproduce(path)
    assert path.read_text(encoding="utf-8") == "mine"


def test_command_refuses_a_file_with_exit_2(tmp_path):
    path = tmp_path / "taken"
    path.write_text("mine", encoding="utf-8")
    answer = subprocess.run(
        [sys.executable, "-m", "spheredrive", "reproduce", "-o", str(path)],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert answer.returncode == 2 and "name a folder" in answer.stderr and Path(path).read_text(encoding="utf-8") == "mine"
