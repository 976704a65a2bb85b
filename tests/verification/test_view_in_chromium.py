"""The browser app and the offline scene as people see them: in a real Chromium, drawn in software, without a network."""

import io
import math
import time

import numpy as np
import pytest

from chromium import EXECUTABLE, Chromium
from layouts import atlas
from spheredrive import kinematics
from spheredrive.app.command import open_page
from spheredrive.app.editing import edited
from spheredrive.designs import design_path
from spheredrive.io.design_file import load_design
from spheredrive.io.design_text import design_text
from spheredrive.io.results import write_run
from spheredrive.motion import Motion, Series
from spheredrive.scene import scene_html
from spheredrive.simulation.simulate import simulate

pytest.importorskip("viser")
pytestmark = pytest.mark.skipif(EXECUTABLE is None, reason="needs Chromium")

DESIGN = design_path("atlas-dual-race")
SHOWS = "!!document.body && document.body.innerText.includes({!r})"
HIDES = "!document.body.innerText.includes({!r})"


@pytest.fixture(scope="module")
def browser():
    with Chromium(1280, 800) as chromium:
        yield chromium


@pytest.fixture(scope="module")
def run_file(tmp_path_factory):
    motion = Motion("wheel-speed", Series((0.0, 20.0), ((1.0, 2.0, 3.0),) * 2), 20.0, sample_rate=50.0)
    return write_run(simulate(load_design(DESIGN), motion), tmp_path_factory.mktemp("run") / "run.nc")


@pytest.fixture(scope="module")
def page(browser, run_file):
    """The page of a design with a run, opened once: what follows is what one person does."""
    begin = time.monotonic()
    opened = open_page(DESIGN, run_file)
    browser.open(opened.url)
    browser.wait(SHOWS.format("Isotropy"))
    browser.wait("!!document.querySelector('canvas')")
    browser.seconds = time.monotonic() - begin
    yield opened
    opened.stop()


def canvas(browser) -> np.ndarray:
    """The pixels between the panels, (h, w, 3), from 0 to 1."""
    from matplotlib.image import imread

    whole = imread(io.BytesIO(browser.picture()))[..., :3]
    box = browser.value("(() => { const b = document.querySelector('canvas').getBoundingClientRect();"
                        "return [b.top, b.bottom, b.left, b.right].map(Math.round) })()")  # fmt: skip
    # Below the notices that may cover its top.
    return whole[max(box[0], 200) : box[1], box[2] : box[3]]


def shown_jacobian(browser) -> np.ndarray:
    """The matrix in the first table under the word Jacobian."""
    cells = browser.value("""(() => {
      const title = [...document.querySelectorAll('div')].find(d => d.textContent.startsWith('Jacobian J') && !d.children[0]);
      const rows = [...title.nextElementSibling.querySelectorAll('tr')].slice(1);
      return rows.map(r => [...r.querySelectorAll('td')].slice(1).map(c => c.textContent));
    })()""")
    return np.array([[float(cell.replace("−", "-")) for cell in row] for row in cells])


def wait_for_picture(browser, differs_from=None, share=0.002, seconds=20.0):
    """The canvas as soon as so many of its pixels differ from those before, or from its background."""
    end = time.monotonic() + seconds
    while True:
        now = canvas(browser)
        other = now[0, 0] if differs_from is None or differs_from.shape != now.shape else differs_from
        if (np.abs(now - other).max(axis=-1) > 0.05).mean() > share:
            return now
        assert time.monotonic() < end, "the picture stays as it was"


def test_the_page_loads_draws_and_asks_nobody_for_anything(browser, page):
    drawn = wait_for_picture(browser, share=0.05)
    # Wheel 1 is blue, wheel 3 green: both are seen from where the page looks from.
    red, green, blue = drawn[..., 0], drawn[..., 1], drawn[..., 2]
    assert ((blue > red + 0.2) & (blue > green + 0.1)).sum() > 50
    assert ((green > red + 0.2) & (green > blue)).sum() > 50
    outside = [url for url in browser.requests() if not url.startswith((page.url, "data:", "blob:", "about:"))]
    assert outside == [] and browser.errors() == []
    assert browser.seconds < 30


def test_a_slider_changes_the_jacobian_that_is_shown_and_the_picture(browser, page):
    assert shown_jacobian(browser) == pytest.approx(kinematics.jacobian(atlas()), abs=6e-5)
    before = canvas(browser)
    browser.type_into("Elevation (°)", "-25")
    expected = kinematics.jacobian(atlas(elevation_deg=-25.0))
    browser.wait(SHOWS.format(f"{expected[0, 0]:.4f}"))
    assert shown_jacobian(browser) == pytest.approx(expected, abs=6e-5)
    wait_for_picture(browser, before)


def test_a_value_that_no_machine_has_is_refused_with_a_sentence(browser, page):
    browser.type_into("Roller angle (°)", "0")
    browser.wait(SHOWS.format("a roller must stand 1 to 90 deg off the wheel's axis"))
    browser.type_into("Roller angle (°)", "85")
    browser.wait(HIDES.format("a roller must stand"))


def test_the_edited_design_is_saved_as_a_file_that_loads(browser, page, tmp_path):
    browser.do("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(tmp_path))
    browser.click("File")
    browser.click("Save the design (.toml)")
    end = time.monotonic() + 20
    while not (tmp_path / "atlas-dual-race.toml").exists():
        assert time.monotonic() < end, "nothing was saved"
        time.sleep(0.02)
    expected = edited(edited(load_design(DESIGN), 0, "elevation", math.radians(-25)), 0, "roller_angle", math.radians(85))
    assert load_design(tmp_path / "atlas-dual-race.toml") == expected


def test_a_run_plays_steps_and_moves_the_picture(browser, page):
    browser.click("Run")
    browser.click("Back to the run's machine")
    browser.wait(HIDES.format("Back to the run"))
    time_box = """(() => { const n = [...document.querySelectorAll('label, div, span')].filter(
      e => !e.childElementCount && e.textContent.trim() === 'Time (s)' && e.offsetParent).at(-1);
      for (let e = n; e; e = e.parentElement) { const i = [...e.querySelectorAll('input')].filter(x => x.type !== 'hidden');
        if (i.length) return Number(i.at(-1).value); } })()"""
    before = canvas(browser)
    browser.click("Play")
    browser.wait(f"{time_box} > 0.5")
    wait_for_picture(browser, before)
    browser.click("Pause")
    browser.wait(SHOWS.format("Play"))
    stopped = browser.value(time_box)
    browser.click("▸")
    # 50 samples a second, and the changes of race between them.
    browser.wait(f"{time_box} > {stopped} && {time_box} < {stopped} + 0.0201")
    assert browser.errors() == []


def test_another_design_is_loaded_from_a_file(browser, page, tmp_path):
    file = tmp_path / "other.toml"
    file.write_text(design_text(atlas(elevation_deg=-55.0, count=4)), encoding="utf-8")
    browser.click("File")
    browser.do("Page.setInterceptFileChooserDialog", enabled=True)
    browser.click("Load a design (.toml) …")
    end = time.monotonic() + 20
    while not (chosen := [e for e in browser.events if e["method"] == "Page.fileChooserOpened"]):
        assert time.monotonic() < end, "no file can be chosen"
        browser.value("0")
    browser.do("DOM.setFileInputFiles", files=[str(file)], backendNodeId=chosen[0]["params"]["backendNodeId"])
    expected = kinematics.jacobian(atlas(elevation_deg=-55.0, count=4))
    browser.wait(SHOWS.format(f"{expected[0, 0]:.4f}"))
    assert shown_jacobian(browser) == pytest.approx(expected, abs=6e-5)


def test_the_offline_scene_draws_and_moves_from_a_file(browser, tmp_path):
    file = tmp_path / "scene.html"
    file.write_text(scene_html(load_design(DESIGN), wheel_speed=[1.0, -2.0, 3.0]), encoding="utf-8")
    browser.events.clear()
    browser.open(file.as_uri())
    browser.wait("window.sceneState && sceneState().time > 0.3")
    first = wait_for_picture(browser, share=0.05)
    wait_for_picture(browser, first)
    assert browser.value("sceneState().samples") > 400
    assert {url.split(":")[0] for url in browser.requests()} <= {"file", "data"} and browser.errors() == []
