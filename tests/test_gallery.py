"""Every example of the gallery, run in this process: it ends by asserting its number."""

import re
import runpy
from pathlib import Path

import matplotlib
import pytest

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.py"))


@pytest.fixture
def pictures(monkeypatch):
    """Figures are drawn and not shown; how many there were."""
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    shown = []

    def show():
        for number in plt.get_fignums():
            plt.figure(number).canvas.draw()
            shown.append(number)
        plt.close("all")

    monkeypatch.setattr(plt, "show", show)
    yield shown
    plt.close("all")


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example_runs_and_its_numbers_hold(example, pictures, tmp_path, monkeypatch, capsys):
    for module in re.findall(r"^(?:import|from) (\w+)", example.read_text(encoding="utf-8"), re.M):
        pytest.importorskip(module)
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(example), run_name="__main__")
    assert pictures, "an example of the gallery draws a figure"
    assert capsys.readouterr().out.strip(), "an example says its number"
    assert not list(tmp_path.iterdir()), "an example leaves no files behind"


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example_asserts_a_number_under_a_question(example):
    text = example.read_text(encoding="utf-8")
    title, underline = text.splitlines()[1:3]
    assert text.startswith('"""\n') and title.endswith("?") and underline == "=" * len(title)
    assert re.search(r"^ *assert |^ *np\.testing\.assert", text, re.M)
