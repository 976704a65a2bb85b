"""Design files: the example of the interface, and what each kind of mistake is told as."""

import math
from pathlib import Path

import numpy as np
import pytest

from spheredrive.errors import InputError
from spheredrive.io.design_file import load_design, parse_design
from spheredrive.io.template import starting_file, write_new

EXAMPLE = Path(__file__).parents[1] / "data" / "interface-example.toml"
TEXT = EXAMPLE.read_text(encoding="utf-8")


def changed(*changes: tuple[str, str]) -> str:
    text = TEXT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return text


def refusal(text: str, **options) -> InputError:
    with pytest.raises(InputError) as caught:
        parse_design(text, "atlas.toml", **options)
    return caught.value


def test_load_design_the_interface_example_gives_its_values():
    design = load_design(EXAMPLE)
    wheel = design.wheels[0]
    assert design.name == "Atlas, dual-race"
    assert (design.sphere.radius, design.sphere.mass, design.sphere.inertia) == (0.15, 2.0, "hollow")
    assert (wheel.type, wheel.name, wheel.radius, wheel.rollers) == ("dual-race", "omni", 0.025, 16)
    assert (wheel.roller_radius, wheel.race_spacing, wheel.roller_angle, wheel.mass) == (0.00485, 0.0125, math.pi / 2, 0.1)
    assert (design.contact.stiffness, design.contact.damping, design.contact.friction) == (188208.0, 0.0, 0.9)
    assert (design.contact.rolling_arm, design.mount.stiffness, design.closure.force) == (None, 1e6, (0.0, 0.0, 0.0))
    assert (design.stage.mass, design.stage.gravity, design.motor.torque) == (5.0, True, 2.0)
    assert design.motor.speed == pytest.approx(10 * math.pi, rel=1e-15)
    assert design.source == TEXT


def test_load_design_the_interface_example_stands_as_the_formulas_say():
    # model.md section 1: R̂ = (cos φ cos θ, sin φ cos θ, −sin θ), v̂ = (−sin φ, cos φ, 0) at φ = 0, 120, 240°, θ = 40°.
    phi, theta = np.radians([0, 120, 240]), math.radians(40)
    level = np.zeros(3)
    contact = np.stack([np.cos(phi) * math.cos(theta), np.sin(phi) * math.cos(theta), level - math.sin(theta)], -1)
    drive = np.stack([-np.sin(phi), np.cos(phi), level], -1)
    design = load_design(EXAMPLE)
    assert np.abs(design.contact_directions - contact).max() < 4e-16
    assert np.abs(design.drive_directions - drive).max() < 4e-16


def test_parse_design_a_ring_starts_at_its_azimuth_and_runs_anticlockwise():
    design = parse_design(changed(("count = 3", "count = 4"), ('azimuth = "0 deg"', 'azimuth = "30 deg"')))
    azimuth = [math.degrees(p.azimuth_elevation_heading[0]) % 360 for p in design.placements]
    assert azimuth == pytest.approx([30, 120, 210, 300], abs=1e-12)


def test_parse_design_vectors_are_normalised_and_exact():
    lines = "[[placement]]\ncontact = [0, 0, 2]\ndrive = [0, 3, 0]\n[contact]"
    placement = parse_design(changed(("[contact]", lines))).placements[3]
    assert (placement.contact_direction, placement.drive_direction, placement.ring) == ((0, 0, 1), (0, 1, 0), 2)


def test_parse_design_bare_numbers_are_si():
    text = changed(('radius = "15 cm"', "radius = 0.15"), ('elevation = "-40 deg"', "elevation = -0.5"))
    assert parse_design(text).sphere.radius == 0.15
    assert parse_design(text).placements[0].azimuth_elevation_heading[1] == pytest.approx(-0.5, rel=1e-15)


@pytest.mark.parametrize(
    ("inertia", "diagonal"),
    [
        ('"solid"', [0.4 * 2 * 0.15**2] * 3),
        ('["0.01 kg m^2", 0.02, "300 kg cm^2"]', [0.01, 0.02, 0.03]),
        ("[[0.01, 0, 0], [0, 0.02, 0], [0, 0, 0.03]]", [0.01, 0.02, 0.03]),
    ],
)
def test_parse_design_inertia_takes_each_of_its_forms(inertia, diagonal):
    design = parse_design(changed(('inertia = "hollow"', f"inertia = {inertia}")))
    assert np.allclose(design.sphere.inertia_tensor, np.diag(diagonal), rtol=1e-15)


def test_parse_design_springs_of_the_closure_are_read():
    spring = parse_design(changed(("# springs", "springs"))).closure.springs[0]
    assert (spring.direction, spring.stiffness, spring.damping) == ((0, 0, 1), 1e4, 0)


def test_parse_design_a_model_that_stands_nowhere_is_allowed():
    text = changed(("[motor]", '[wheels.spare]\ntype = "ideal"\nradius = 1\n[motor]'))
    assert parse_design(text).wheel_count == 3


def test_parse_design_catalogue_gives_keys_and_the_file_overrides():
    wheel = 'schema_version = 1\nname = "x"\n[sphere]\nradius = 1\n[wheels.a]\ncatalogue = "sunfounder/zeus-60mm-mecanum"\n'
    text = wheel + 'radius = "31 mm"\n[[placement]]\ncount = 1\nelevation = 0\n'
    model = parse_design(text).wheels[0]
    assert (model.type, model.radius, model.rollers, model.roller_angle) == ("mecanum", 0.031, 9, math.pi / 4)


# (what is changed, into what, place, length of the caret, words)
MISTAKES = [
    ('radius = "15 cm"', 'raduis = "15 cm"', "5:1", 6, ["sphere.raduis", "unknown key", "did you mean 'radius'"]),
    ("[sphere]", "[spehre]", "4:2", 6, ["unknown key 'spehre'", "did you mean 'sphere'"]),
    ('type = "dual-race"', 'type = "dual-rase"', "11:8", 11, ["no wheel type", "did you mean 'dual-race'"]),
    ('type = "dual-race"', "", "10:1", 13, ["lacks the key type", "ideal, standard, dual-race, split-dual-race"]),
    ('radius = "15 cm"', "", "4:1", 8, ["sphere: lacks the key radius"]),
    ('name = "Atlas, dual-race"', "", "1:1", 1, ["lacks name"]),
    ("schema_version = 1\n", "", "1:1", 1, ["lacks schema_version", "schema_version = 1"]),
    ("schema_version = 1", "schema_version = 2", "1:18", 1, ["is 2", "schema_version = 1"]),
    ("schema_version = 1", "schema_version = true", "1:18", 4, ["is true"]),
    ('radius = "15 cm"', 'radius = "25 kg"', "5:10", 7, ["is a mass", "radius takes a length", '"25 mm"']),
    ('radius = "15 cm"', 'radius = "15"', "5:10", 4, ["lacks a unit"]),
    ('radius = "15 cm"', 'radius = "25,4 mm"', "5:10", 9, ['write "25.4 mm"']),
    ('radius = "15 cm"', 'radius = "15 cn"', "5:10", 7, ["unknown unit 'cn'", "choose from m, cm, "]),
    ('radius = "15 cm"', "radius = 25 mm", "5:13", 1, ["in quotes"]),
    ('radius = "15 cm"', "radius = nan", "5:10", 3, ["finite"]),
    ('radius = "15 cm"', "radius = -inf", "5:10", 4, ["finite"]),
    ('radius = "15 cm"', 'radius = "nan m"', "5:10", 7, ["finite"]),
    ('radius = "15 cm"', "radius = -1", "5:10", 2, ["greater than zero"]),
    ('radius = "15 cm"', "radius = true", "5:10", 4, ["takes a number, not true"]),
    ('radius = "15 cm"', "radius = [1, 2]", "5:10", 6, ["takes a number, not a list"]),
    ('radius = "15 cm"', "radius = 1e300", "5:10", 5, ["not a size that a machine can have"]),
    ('radius = "15 cm"', "radius = " + "1" * 400, "5:10", 151, ["finite"]),
    ('radius = "15 cm"', "radius = 1979-05-27", "5:10", 10, ["takes a number"]),
    ('radius = "15 cm"', 'radius = "15 cm"\nradius = 3', "6:1", 1, ["given twice"]),
    ('inertia = "hollow"', 'inertia = "holow"', "7:11", 7, ["did you mean 'hollow'"]),
    ('inertia = "hollow"', "inertia = [1, 2, 9]", "7:11", 9, ["no body can have"]),
    ('inertia = "hollow"', 'inertia = [[1, 0, 0], [0, "2 m", 0], [0, 0, 1]]', "7:27", 5, ["a length"]),
    ('inertia = "hollow"', "inertia = [1, 2]", "7:11", 6, ["three moments or a 3x3 table"]),
    ('["0 mm", "0 mm", "0 mm"]', '["0 mm", "0 kg", "0 mm"]', "8:27", 6, ["a mass", "a length"]),
    ('["0 mm", "0 mm", "0 mm"]', '["0 mm", "0 mm"]', "8:18", 16, ["list of 3 numbers"]),
    ('["0 mm", "0 mm", "0 mm"]', '["9 cm", "9 cm", "9 cm"]', "8:18", 24, ["inside the sphere"]),
    ("rollers = 16", "rollers = 17", "13:11", 2, ["do not share out over 2 equal races"]),
    ("rollers = 16", "rollers = 16.0", "13:11", 4, ["whole number"]),
    ('roller_radius = "4.85 mm"', 'roller_radius = "30 mm"', "14:17", 7, ["does not fit"]),
    ('race_spacing = "12.5 mm"', 'race_spacing = "500 mm"', "15:16", 8, ["closer together"]),
    ('race_spacing = "12.5 mm"', "", "10:1", 13, ["lacks the key race_spacing"]),
    ('# roller_angle = "45 deg"', 'roller_angle = "45 m"', "16:16", 6, ["a length", "an angle"]),
    ('# roller_angle = "45 deg"', 'roller_angle = "0.2 deg"', "16:16", 9, ["1 to 90 deg"]),
    ('# roller_shape = "barrel"', 'roller_shape = "barel" #', "17:16", 7, ["did you mean 'barrel'"]),
    ("# roundness", "roundness", "18:1", 9, ["unknown key 'roundness'"]),
    ("# catalogue", "catalogue", "22:13", 12, ["no part of the catalogue"]),
    ("[wheels.omni]", "[wheels]\nspare = 5\n[wheels.omni]", "11:9", 1, ["takes a table"]),
    ('wheel = "omni"', 'wheel = "omin"', "25:9", 6, ["no wheel model 'omin'", "did you mean 'omni'"]),
    ("count = 3", "count = 0", "26:9", 1, ["from 1 to 1000"]),
    ("count = 3", "count = 1001", "26:9", 4, ["from 1 to 1000"]),
    ("count = 3", 'count = "3"', "26:9", 3, ["whole number"]),
    ('elevation = "-40 deg"', 'elevation = "-40"', "28:13", 5, ["lacks a unit", "an angle"]),
    ('elevation = "-40 deg"', 'elevation = "90 deg"', "24:1", 13, ["same point"]),
    ("[[placement]]", "[placement]", "24:1", 11, ["takes a list of tables"]),
    ("friction = 0.9", "friction = -0.1", "38:12", 4, ["cannot be negative"]),
    ("friction = 0.9", 'friction = "9 deg"', "38:12", 7, ["an angle", "a plain number"]),
    ("# springs = [{ direction = [0, 0, 1]", "springs = [{ direction = [0, 0, 0]", "48:26", 9, ["points nowhere"]),
    ("# springs = [{ direction = [0, 0, 1], stiff", "springs = [{ direction = [0, 0, 1], stif", "48:37", 8, ["did you mean"]),
    ("[stage]", "[[stage]]", "49:1", 9, ["takes a table"]),
    ("gravity = true", "gravity = 1", "51:11", 1, ["true or false"]),
    ('speed = "300 rpm"', 'speed = "300 Hz"', "54:9", 8, ["a frequency", '"300 rpm"']),
    ('name = "Atlas, dual-race"', 'name = "a\\u001b[31m"', "2:8", 13, ["one line of text"]),
    ('name = "Atlas, dual-race"', "name = 5", "2:8", 1, ["text in quotes"]),
]


@pytest.mark.parametrize(("old", "new", "place", "length", "words"), MISTAKES, ids=[f"{m[1][:40]}" for m in MISTAKES])
def test_parse_design_a_mistake_is_told_with_its_place_and_rule(old, new, place, length, words):
    error = refusal(changed((old, new)))
    lines = str(error).split("\n")
    assert lines[0].startswith(f"atlas.toml:{place}: ")
    for word in words:
        assert word in lines[0]
    column = int(place.split(":")[1])
    assert lines[2] == "  " + " " * (column - 1) + "^" * length


def test_parse_design_the_line_under_the_message_is_the_file_s():
    error = refusal(changed(('radius = "15 cm"', '\tradius = "25 kg"')))
    assert str(error).split("\n")[1:] == ['  \tradius = "25 kg"', "  \t         ^^^^^^^"]


def test_parse_design_the_first_of_several_is_told_and_the_rest_counted():
    text = changed(("[motor]", "[motor]\nfoo = 1"), ("friction = 0.9", "friction = -1"), ('"15 cm"', '"15 kg"'))
    assert str(refusal(text)).startswith("atlas.toml:5:10: ")
    assert "(2 more problems in this file)" in str(refusal(text))


def test_parse_design_a_ring_and_vectors_do_not_mix():
    error = refusal(changed(('elevation = "-40 deg"', "contact = [1, 0, 0]\ndrive = [0, 0, 1]")))
    assert str(error).startswith("atlas.toml:26:1: ")
    assert "not both" in str(error)


def test_parse_design_vectors_that_are_not_perpendicular_are_refused():
    error = refusal(changed(("[contact]", "[[placement]]\ncontact = [1, 0, 0]\ndrive = [1, 0, 1]\n[contact]")))
    assert str(error).startswith("atlas.toml:37:9: placement.drive: must be perpendicular")


def test_parse_design_two_wheels_at_one_place_are_refused_at_the_second():
    again = '[[placement]]\ncount = 3\nelevation = "-40 deg"\n[contact]'
    assert str(refusal(changed(("[contact]", again)))).startswith("atlas.toml:35:1: placement: wheels 1 and 4 touch")


def test_parse_design_the_model_must_be_named_where_there_are_several():
    spare = '[wheels.spare]\ntype = "ideal"\nradius = 1\n[motor]'
    error = refusal(changed(('wheel = "omni"', ""), ("[motor]", spare)))
    assert str(error).startswith("atlas.toml:24:1: placement: lacks the key wheel")


def test_parse_design_a_model_s_name_is_a_line_of_text():
    for name in ("", "\\u001b[31m", "x" * 200):
        spare = f'[wheels."{name}"]\ntype = "ideal"\nradius = 1\n[motor]'
        assert str(refusal(changed(("[motor]", spare)))).startswith("atlas.toml:52:1: wheels")


def test_parse_design_more_wheels_than_a_thousand_are_refused_at_once():
    ring = "[[placement]]\ncount = 1000\nelevation = 0\n"
    error = refusal(changed(("[contact]", ring * 500 + "[contact]")))
    assert "500003 wheels" in str(error)


def test_parse_design_the_catalogue_s_type_is_not_overridden():
    error = refusal(changed(('# catalogue = "maker/part"', 'catalogue = "sunfounder/zeus-60mm-mecanum"')))
    assert str(error).startswith("atlas.toml:11:8: wheels.omni.type: ")
    assert "is a mecanum wheel" in str(error)


MEASURED = """schema_version = 1
name = "measured"
[sphere]
radius = "15 cm"
[wheels.m]
type = "measured"
file = "wheel.csv"
[[placement]]
count = 3
elevation = "-40 deg"
"""


def test_load_design_a_measured_outline_is_read_beside_the_file(tmp_path):
    (tmp_path / "design.toml").write_text(MEASURED)
    (tmp_path / "wheel.csv").write_text("angle,radius\n0,0.025\n2,0.026\n4,0.025\n")
    wheel = load_design(tmp_path / "design.toml").wheels[0]
    assert wheel.outline == ((0.0, 0.025), (2.0, 0.026), (4.0, 0.025))
    assert wheel.radius == wheel.mean_radius


@pytest.mark.parametrize(
    ("table", "place", "words"),
    [
        ("angle;radius\n0;1\n", "wheel.csv:1:1", "parted by commas"),
        ("angle,radius\n", "wheel.csv:1:1", "no rows"),
        ("radius,angle\n0,1\n", "wheel.csv:1:1", "angle,radius"),
        ("angle,radius\n0,0.025\n1\n2,0.025\n", "wheel.csv:3:1", "1 entries, the header 2"),
        ("angle,radius\n0,0.025,7\n", "wheel.csv:2:9", "3 entries"),
        ("angle,radius\n0,0.025\n1,nan\n", "wheel.csv:3:3", "finite"),
        ("angle,radius\n0,0.025\n1, mm\n", "wheel.csv:3:4", "takes a number in SI"),
        ("angle,radius\n0,0.025\n1,\n", "wheel.csv:3:3", "missing"),
        ("angle,radius\n0,0.025\n\n1,0.025\n", "wheel.csv:3:1", "empty"),
        ("angle,radius\n0,0.025\n2,0.026\n1,0.025\n", "wheel.csv:4:1", "must rise"),
        ("angle,radius\n0,0.025\n1,1_0\n", "wheel.csv:3:3", "takes a number in SI"),
        ("angle,radius\n0,0.025\n1,0.03\n9,0.025\n", "design.toml:7:8", "within one turn"),
        ("angle,radius\n0,0.025\n1,0.03\n2,-1\n", "design.toml:7:8", "greater than zero"),
        ("angle,radius\n0,0.025\n1,0.03\n", "design.toml:7:8", "three points"),
        (None, "design.toml:7:8", "no such file"),
    ],
)
def test_load_design_a_faulty_outline_is_told_with_its_place(tmp_path, table, place, words):
    (tmp_path / "design.toml").write_text(MEASURED)
    if table is not None:
        (tmp_path / "wheel.csv").write_text(table)
    with pytest.raises(InputError) as caught:
        load_design(tmp_path / "design.toml")
    assert str(caught.value).startswith(f"{tmp_path / place}: ")
    assert words in str(caught.value)


def test_starting_file_loads_and_names_every_key():
    from spheredrive.io.schema import design_model, wheel_models
    from spheredrive.io.sections import Ring, Vectors

    design = parse_design(starting_file())
    assert design.wheel_count == 3
    keys = {key for model in wheel_models().values() for key in model.model_fields}
    keys |= {*Ring.__dataclass_fields__, *Vectors.__dataclass_fields__, *design_model().model_fields}
    for part in (design.sphere, design.contact, design.mount, design.closure, design.stage, design.motor):
        keys |= set(part.__dataclass_fields__)
    for key in keys - {"wheels", "placement"}:
        assert f"{key} = " in starting_file() or f"[{key}]" in starting_file(), key


def test_write_new_does_not_overwrite(tmp_path):
    path = tmp_path / "mine.toml"
    write_new(path)
    assert load_design(path).name == "My machine"
    path.write_text("mine")
    with pytest.raises(InputError, match="exists already"):
        write_new(path)
    assert path.read_text() == "mine"
