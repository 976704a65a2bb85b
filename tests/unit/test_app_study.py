"""Results of studies as points to choose from: the machine of a point is the one that the study worked out."""

import math

import numpy as np
import pytest
import xarray

from spheredrive import kinematics
from spheredrive.app.board import HEIGHT, WIDTH, Board
from spheredrive.app.command import open_page
from spheredrive.app.server import start_server
from spheredrive.app.session import Session
from spheredrive.app.study import is_study, read_study_result
from spheredrive.designs import design_path
from spheredrive.errors import InputError

pytest.importorskip("viser")

BASE = design_path("atlas-dual-race").read_text(encoding="utf-8")
STUDY = """
design = "atlas.toml"
metrics = ["isotropy", "effectiveness_min"]
[parameters]
"placement.elevation" = { from = "-60 deg", to = "-20 deg", count = 3 }
"wheels.omni.roller_angle" = ["90 deg", "60 deg"]
"""
OBJECTIVES = STUDY + '[objectives]\nisotropy = "max"\neffectiveness_min = "max"\n'
ELEVATION = np.radians([-60.0, -40.0, -20.0])
ROLLER = np.radians([90.0, 60.0])


def written(folder, grid: bool, study: str = STUDY):
    """A result as the interface has it: a dimension a parameter, or one of points; the metric of a point is its number."""
    attrs = {"design": BASE, "study": study, "title": "Study of Atlas"}
    numbers = np.arange(6.0).reshape(3, 2)
    if grid:
        dims = ("placement.elevation", "wheels.omni.roller_angle")
        coords = {
            dims[0]: (dims[0], ELEVATION, {"units": "rad"}),
            dims[1]: (dims[1], ROLLER, {"units": "rad"}),
        }
        data = {
            "isotropy": (dims, numbers),
            "effectiveness_min": (dims, -((numbers - 3) ** 2)),
            "status": (dims, numbers.astype("i1")),
        }
        found = xarray.Dataset(data, coords, attrs)
    else:
        one, other = (part.ravel() for part in np.meshgrid(ELEVATION, ROLLER, indexing="ij"))
        flat = numbers.ravel()
        data = {
            "placement.elevation": ("point", one, {"units": "rad"}),
            "wheels.omni.roller_angle": ("point", other, {"units": "rad"}),
            "isotropy": ("point", flat),
            "effectiveness_min": ("point", np.where(flat == 5, np.nan, -((flat - 3) ** 2))),
            "status": ("point", flat.astype("i1")),
        }
        found = xarray.Dataset(data, attrs=attrs)
    folder.mkdir(exist_ok=True)
    found.to_netcdf(folder / "result.nc", engine="h5netcdf")
    return folder


@pytest.mark.parametrize("grid", [True, False])
def test_design_of_a_point_has_the_values_of_the_point(tmp_path, grid):
    result = read_study_result(written(tmp_path / "o", grid))
    assert result.count == 6
    for point in range(6):
        design = result.design(point)
        assert result.metrics["isotropy"][point] == point
        assert design.placements[0].azimuth_elevation_heading[1] == pytest.approx(ELEVATION[point // 2], abs=1e-15)
        assert design.wheels[0].roller_angle == ROLLER[point % 2]


def test_design_of_a_point_takes_words(tmp_path):
    study = 'metrics = ["isotropy"]\n[parameters]\n"wheels.omni.roller_shape" = ["barrel", "capsule"]\n'
    name = "wheels.omni.roller_shape"
    data = {"isotropy": ((name,), [0.1, 0.2]), "status": ((name,), np.zeros(2, "i1"))}
    found = xarray.Dataset(data, {name: (name, np.array(["barrel", "capsule"]))}, {"design": BASE, "study": study})
    found.to_netcdf(tmp_path / "result.nc", engine="h5netcdf")
    result = read_study_result(tmp_path / "result.nc")
    assert [result.design(point).wheels[0].roller_shape for point in range(2)] == ["barrel", "capsule"]


def test_front_keeps_what_no_other_point_beats(tmp_path):
    # Isotropy k and −(k − 3)², both to be large: below 3 both rise, so 3 beats what is before; beyond it they disagree.
    assert read_study_result(written(tmp_path / "g", True, OBJECTIVES)).front("isotropy", "effectiveness_min").tolist() == [
        3,
        4,
        5,
    ]
    result = read_study_result(written(tmp_path / "p", False, OBJECTIVES))
    assert result.front("isotropy", "effectiveness_min").tolist() == [3, 4]
    assert read_study_result(written(tmp_path / "n", True)).front("isotropy", "effectiveness_min").tolist() == list(range(6))


def test_read_study_result_says_what_is_wrong(tmp_path):
    with pytest.raises(InputError, match=r"no result\.nc"):
        read_study_result(tmp_path)
    (tmp_path / "result.nc").write_bytes(b"nothing")
    with pytest.raises(InputError, match="damaged"):
        read_study_result(tmp_path)
    xarray.Dataset({"a": 1}).to_netcdf(tmp_path / "result.nc", engine="h5netcdf")
    with pytest.raises(InputError, match="no result of a study"):
        read_study_result(tmp_path)
    assert is_study(tmp_path) and is_study(tmp_path / "result.nc") and not is_study(tmp_path / "run.nc")


@pytest.fixture(scope="module")
def server():
    running = start_server()
    yield running
    running.stop()


def test_board_chooses_the_point_under_the_ray(server, tmp_path):
    chosen = []
    board = Board(server, chosen.append)
    x, y = np.array([0.0, 1.0, 2.0, np.nan]), np.array([0.0, 5.0, 1.0, 2.0])
    board.show(x, y, np.array([0, 1]), ("x", "y"))
    # From a camera in front of the board to each point's place on it: 4 % within its edges.
    camera = board._origin + board._frame @ [1.0, 0.5, 6.0]
    for point in range(3):
        place = np.array([0.04 + 0.92 * x[point] / 2, 0.04 + 0.92 * y[point] / 5]) * [WIDTH, HEIGHT]
        board._click(camera, board._origin + board._frame @ [*(place + 0.05), 0.0] - camera)
    assert chosen == [0, 1, 2]


def test_session_shows_the_machine_of_the_chosen_point(server, tmp_path):
    server.gui.reset()
    server.scene.reset()
    result = read_study_result(written(tmp_path / "o", True, OBJECTIVES))
    session = Session(server, result.base(), None, result)
    panel = session.study_panel
    assert panel.point == 4
    panel.choose(3)
    assert session.design == result.design(3)
    assert session._answers.check.jacobian == pytest.approx(kinematics.jacobian(result.design(3)))
    assert "Point 4" in panel.text.content and "−40°" in panel.text.content and "60°" in panel.text.content
    assert int(panel.along.value) == 1 and math.isfinite(session._answers.check.isotropy)


def test_open_page_takes_a_folder_of_results(tmp_path):
    page = open_page(written(tmp_path / "o", False))
    page.stop()
    assert page.url == f"http://127.0.0.1:{page.port}/"
