"""Study files: the example of the interface loads as printed, and what is wrong is said with its place."""

import math
import tomllib
from pathlib import Path

import pytest

from spheredrive.errors import DesignError, InputError
from spheredrive.io.catalogue import catalogue
from spheredrive.io.design_file import parse_design
from spheredrive.io.design_path import assigned, resolve
from spheredrive.io.study import Algorithm, Constraint, Metric, Objective, Sampling
from spheredrive.io.study_file import load_study, parse_study
from spheredrive.io.toml_text import toml_text

DATA = Path(__file__).parents[1] / "data"
DESIGN = (DATA / "interface-example.toml").read_text("utf-8")
EXAMPLE = """schema_version = 1
design = "atlas.toml"                  # paths relative to this file
# motion = "motion.toml"               # where a metric needs one
speeds = "2 2 2 rad/s"                 # for vibration metrics
metrics = ["isotropy", "condition_number", "effectiveness_min", "preload", "rms_acceleration"]
[parameters]                           # any path into the design; placements and wheels by name or number
"placement.elevation" = { from = "-60 deg", to = "-20 deg", count = 41 }
"wheels.omni.roller_angle" = ["90 deg", "60 deg", "45 deg"]
# "sphere.mass" = { normal = ["2 kg", "0.1 kg"] }        # distributions, for random and latin-hypercube
[sampling]
method = "grid"                        # grid, list, random, latin-hypercube, sobol
# size = 1000
seed = 1
"""
MORE = """[objectives]
isotropy = "max"
[constraints]
clearance = ">= 5 mm"
isotropy = ">= 0.3"
[algorithm]
name = "nsga2"
population = 40
"""
UNITS = {"isotropy": "", "condition_number": "", "effectiveness_min": "", "preload": "N", "clearance": "m"}
METRICS = {name: Metric(name, unit, "") for name, unit in UNITS.items()}
METRICS["rms_acceleration"] = Metric("rms_acceleration", "m/s^2", "", ("speeds",))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("studies")
    (folder / "atlas.toml").write_text(DESIGN, "utf-8")
    (folder / "study.toml").write_text(EXAMPLE, "utf-8")
    return folder


def test_the_printed_example_loads_as_printed(folder):
    study = load_study(folder / "study.toml", METRICS)
    assert study.design.name == "Atlas, dual-race" and study.speeds == (2.0, 2.0, 2.0)
    assert study.sampling == Sampling("grid", None, 1)
    elevation, angle = study.parameters
    # Each value is the double that its text would be read as, so that a finer range meets the coarser one's values.
    assert elevation.numbers == tuple(math.radians(-60 + k) for k in range(41)) and elevation.unit == "rad"
    assert angle.numbers == tuple(map(math.radians, (90, 60, 45)))


def test_what_optimisation_asks_for_is_read_and_kept(folder):
    study = parse_study(EXAMPLE + MORE, METRICS, folder=folder)
    assert study.objectives == (Objective("isotropy", "max"),)
    assert study.constraints == (Constraint("clearance", ">=", 0.005), Constraint("isotropy", ">=", 0.3))
    assert study.algorithm == Algorithm("nsga2", 40, None)


def swept(line: str, method: str = 'method = "random"\nsize = 10') -> str:
    head = 'schema_version = 1\ndesign = "atlas.toml"\nmetrics = ["isotropy"]\n[parameters]\n'
    return f"{head}{line}\n[sampling]\n{method}\n"


@pytest.mark.parametrize(
    ("line", "law", "numbers"),
    [
        ('"sphere.mass" = { normal = ["2 kg", "100 g"] }', "normal", (2.0, 0.1)),
        ('"sphere.mass" = { tolerance = "50 g" }', "tolerance", (2.0, 0.05)),
        ('"closure.force.z" = { uniform = ["-5 N", "5 N"] }', "uniform", (-5.0, 5.0)),
        ('"contact.friction" = { triangular = [0.5, 0.8, 0.9] }', "triangular", (0.5, 0.8, 0.9)),
        ('"wheels.rollers" = { from = 8, to = 16, count = 5 }', "values", (8.0, 10.0, 12.0, 14.0, 16.0)),
        ('"sphere.mass" = "3 kg"', "values", (3.0,)),
    ],
)
def test_laws_of_a_parameter(folder, line, law, numbers):
    (parameter,) = parse_study(swept(line), METRICS, folder=folder).parameters
    assert (parameter.law, parameter.numbers) == (law, numbers)


def test_words_and_vectors_are_choices(folder):
    line = '"closure.force" = [["0 N", "0 N", "-1 N"], [0, 0, -2]]\n"wheels.omni.roller_shape" = ["barrel", "cylinder"]'
    force, shape = parse_study(swept(line), METRICS, folder=folder).parameters
    assert force.choices == ((0.0, 0.0, -1.0), (0.0, 0.0, -2.0)) and shape.choices == ("barrel", "cylinder")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"placement.elevation"', '"placement.elevatoin"', r":7:1: .*no key 'elevatoin'; did you mean 'elevation'\?"),
        ('"placement.elevation"', '"placment.elevation"', r":7:1: .*did you mean 'placement'\?"),
        ("wheels.omni.roller", "wheels.omi.roller", r":8:1: .*no wheel model 'omi'; did you mean 'omni'\?"),
        ('"placement.elevation"', '"placement.2.elevation"', ":7:1: .*no placement '2'; this design has 1"),
        ('"wheels.omni.roller_angle"', '"placement.1.elevation"', ":8:1: .*writes where placement.elevation does"),
        ('"-60 deg"', '"-60 mm"', ":7:34: .*is a length, but elevation takes an angle"),
        ('"preload"', '"prelaod"', r":5:65: .*did you mean 'preload'\?"),
        ('speeds = "2', '# speeds = "2', ":5:76: .*rms_acceleration needs speeds"),
        ('"atlas.toml"', '"nothere.toml"', ":2:10: .*there is no such file"),
        ('# "sphere.mass"', '"sphere.mass"', ':9:28: .*a grid takes values; for a distribution write method = "random"'),
        ('["90 deg", "60 deg"', '["90 deg", "90 deg"', ":8:41: .*is given twice"),
        ("# size = 1000", "size = 1000", ":12:8: .*is settled by the values of a grid"),
        ('method = "grid"', 'method = "sobol"', "sampling: lacks the key size"),
        ('"max"', '"most"', r"objectives.isotropy: \"most\" is not known"),
        ('">= 5 mm"', '"5 mm"', 'constraints.clearance: takes text such as ">= 5 mm"'),
        ("population = 40", "population = 1", "algorithm.population: must be from 2"),
        ("[sampling]", "[smapling]", r"did you mean 'sampling'\?"),
    ],
)
def test_what_is_wrong_is_said_with_its_place(folder, old, new, words):
    text = EXAMPLE + MORE
    assert old in text
    with pytest.raises(InputError, match=words):
        parse_study(text.replace(old, new, 1), METRICS, folder=folder)


def test_a_range_without_count_is_for_a_search(folder):
    text = EXAMPLE.replace(", count = 41", "")
    with pytest.raises(InputError, match=r":7:25: .*lacks the key count"):
        parse_study(text, METRICS, folder=folder)
    elevation, _ = parse_study(text + MORE, METRICS, folder=folder).parameters
    assert elevation.law == "uniform" and elevation.numbers == (math.radians(-60), math.radians(-20))


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ('"wheels.rollers" = { from = 8, to = 16, count = 4 }', "gives 10.6667, but takes whole numbers"),
        ('"wheels.rollers" = { normal = [8, 1] }', "counts whole things"),
        ('"closure.force" = { from = "1 N", to = "2 N" }', "takes a list of values"),
        ('"closure.force.4" = ["1 N"]', "from 1 to 3, or x, y, z"),
        ('"sphere.mass" = { normal = ["2 kg", "0 kg"] }', "standard deviation above zero"),
        ('"stage" = [1]', "leads to a whole table"),
        ('"sphere.mass.2" = [1]', "single value"),
        ('"contact.rolling_arm" = { tolerance = "1 mm" }', "no single value in the design"),
    ],
)
def test_laws_that_cannot_be_are_refused(folder, line, words):
    with pytest.raises(InputError, match=words):
        parse_study(swept(line), METRICS, folder=folder)


def test_text_of_plain_data_reads_back_to_the_last_bit():
    data = tomllib.loads(DESIGN)
    data["sphere"]["mass"] = 0.1 + 0.2
    data["odd"] = {"a b": [1e-300, -0.0, True, 'quote " and \\ \n'], "rows": [{"x": [1, 2]}, {"x": []}]}
    assert tomllib.loads(toml_text(data)) == data


def test_assigned_changes_what_a_path_names_and_nothing_else():
    data = tomllib.loads(DESIGN)
    kept = toml_text(data)
    paths = [resolve(text, data) for text in ("closure.force.z", "placement.1.elevation", "mount.damping")]
    design = parse_design(toml_text(assigned(data, zip(paths, (-3.0, -0.5, 7.0), strict=True))))
    assert design.closure.force == (0.0, 0.0, -3.0) and design.mount.damping == 7.0
    assert design.placements[2].azimuth_elevation_heading[1] == pytest.approx(-0.5, abs=1e-15)
    assert toml_text(data) == kept


def test_another_part_of_the_catalogue_brings_its_own_geometry():
    data = tomllib.loads(DESIGN)
    part = resolve("wheels.omni.catalogue", data)
    wheel = parse_design(toml_text(assigned(data, [(part, "nexus/14073")]))).wheels[0]
    published = catalogue()["nexus/14073"]
    assert (wheel.radius, wheel.mass) == (published.radius, published.mass) != (0.025, 0.1)
    # Nobody publishes the spacing of its races: the base's own stays.
    assert published.race_spacing is None and wheel.race_spacing == 0.0125
    with pytest.raises(DesignError, match="is not known"):
        part.read("nexus/1407")


def test_another_type_drops_the_keys_it_does_not_have():
    data = tomllib.loads(DESIGN)
    wheel = parse_design(toml_text(assigned(data, [(resolve("wheels.omni.type", data), "standard")]))).wheels[0]
    assert (wheel.type, wheel.rollers, wheel.radius) == ("standard", 16, 0.025)
