"""The catalogue of real wheels: every figure says where it was read, and a part makes a wheel or says what it lacks."""

import math
import re

import pytest

from spheredrive.errors import DesignError, InputError, UnknownNameError
from spheredrive.io.catalogue import Part, catalogue, parse_range, part, parts
from spheredrive.io.catalogue_text import part_text, parts_text
from spheredrive.io.design_file import parse_design

DESIGN = """schema_version = 1
name = "one part"
[sphere]
radius = "1 m"
[wheels.part]
{keys}
[[placement]]
count = 3
elevation = "-40 deg"
"""
# What no source gives, as a reader would add it; roller_radius fits the smallest part.
ADDED = {"type": '"dual-race"', "rollers": "12", "roller_radius": '"2 mm"', "race_spacing": '"8 mm"'}
COMPLETE = [p.name for p in parts() if not p.missing]
LACKING = [p.name for p in parts() if p.missing]


def design(name, **keys):
    lines = [f'catalogue = "{name}"', *(f"{key} = {value}" for key, value in keys.items())]
    return DESIGN.format(keys="\n".join(lines))


def test_catalogue_has_at_least_ten_parts_of_several_makers_and_types():
    assert len(catalogue()) >= 10
    assert len({p.maker for p in parts()}) >= 5
    assert {p.type for p in parts()} >= {"mecanum", "dual-race", "standard"}
    assert list(catalogue()) == sorted(catalogue())


@pytest.mark.parametrize("name", catalogue())
def test_catalogue_every_figure_names_its_source(name):
    entry = catalogue()[name]
    figures = {key for key in Part.__dataclass_fields__ if Part.__dataclass_fields__[key].metadata}
    given = {key for key in figures if getattr(entry, key) is not None}
    assert set(entry.sources) == given and all(entry.sources.values())
    assert set(entry.keys) == given - {"width", "load"}
    assert all(address.startswith("https://") for read in entry.sources.values() for address in read)
    assert entry.maker and entry.part and re.fullmatch(r"[a-z]+/[\w-]+", name)


@pytest.mark.parametrize("name", catalogue())
def test_catalogue_figures_are_those_of_a_wheel(name):
    entry = catalogue()[name]
    assert 10e-3 < entry.diameter < 0.5
    assert entry.roller_radius is None or entry.roller_radius < entry.radius / 3
    assert entry.mass is None or entry.load is None or entry.load > 10 * entry.mass


@pytest.mark.parametrize("name", COMPLETE)
def test_part_wheel_is_the_one_a_design_file_takes(name):
    assert part(name).wheel(name="part") == parse_design(design(name)).wheels[0]


@pytest.mark.parametrize("name", LACKING)
def test_part_that_lacks_a_figure_says_which_and_works_with_it(name):
    given = {}
    # A part without a type lacks that first; with it, the rest.
    while missing := [key for key in ADDED if key not in given and key not in part(name).keys]:
        with pytest.raises(InputError) as refusal:
            parse_design(design(name, **given))
        sentence = str(refusal.value).splitlines()[0]
        told = missing[:1] if missing[0] == "type" else missing
        assert sentence.startswith("design.toml:6:13: wheels.part.catalogue: ") and f"of {name}" in sentence
        assert [key for key in ADDED if re.search(rf"\b{key}\b", sentence)] == told
        given |= {key: ADDED[key] for key in told}
    wheel = parse_design(design(name, **given)).wheels[0]
    assert (wheel.type, wheel.radius) == (part(name).type or "dual-race", part(name).radius)


def test_part_figures_are_converted():
    kit = part("andymark/8in-mecanum-kit")
    # 8 in = 203.2 mm and 2.5 lb = 1.13398093 kg, by definition of the inch and the pound.
    assert kit.diameter == pytest.approx(0.2032, rel=1e-12) and kit.mass == pytest.approx(1.13398092500, rel=1e-12)
    assert part("fuji/FM202-205-15U").roller_angle == pytest.approx(math.pi / 4)


def test_part_wheel_takes_more_keys_in_si_and_refuses_what_contradicts():
    wheel = part("nexus/14073").wheel(race_spacing=0.015, mass=0.5)
    assert (wheel.race_spacing, wheel.mass, wheel.rollers, wheel.name) == (0.015, 0.5, 22, "nexus/14073")
    with pytest.raises(DesignError, match="gives the race_spacing of nexus/14073; add this key"):
        part("nexus/14073").wheel()
    with pytest.raises(DesignError, match="is a dual-race wheel in the catalogue"):
        part("nexus/14073").wheel(type="mecanum", race_spacing=0.015)
    with pytest.raises(DesignError, match="no such key; did you mean 'race_spacing'"):
        part("nexus/14073").wheel(race_spacing=0.015, race_spacings=0.015)
    with pytest.raises(UnknownNameError, match="dual-race"):
        part("nexus/14145").wheel(type="dual-rase")


def test_part_of_unpublished_type_leaves_out_keys_that_the_type_given_does_not_have():
    assert part("nexus/14145").wheel(type="ideal").radius == 0.03
    assert parse_design(design("nexus/14145", type='"ideal"')).wheels[0].mass == 0.073


def test_part_unknown_name_gets_the_nearest():
    with pytest.raises(UnknownNameError, match="did you mean 'nexus/14073'"):
        part("nexus/1407")
    with pytest.raises(InputError, match="did you mean 'nexus/14073'"):
        parse_design(design("nexus/1407"))


def names(**filters):
    return [p.name for p in parts(**filters)]


def test_parts_filters_are_and_ed_and_unpublished_figures_do_not_fit():
    assert names() == list(catalogue())
    assert names(wheel_type="mecanum", rollers=(9, 10)) == ["gobilda/3606-0000-0096", "sunfounder/zeus-60mm-mecanum"]
    assert names(maker="nexus") == names(maker="Nexus Robot") == [n for n in catalogue() if n.startswith("nexus/")]
    assert names(maker="nexus", diameter=(0.1, 0.127)) == ["nexus/100mm-mecanum", "nexus/14073", "nexus/14182"]
    assert names(text="double ALUMINIUM 48") == ["nexus/14148"]
    assert names(text="nobody's") == []
    assert all(p.rollers is not None for p in parts(rollers=(0, math.inf)))


@pytest.mark.parametrize("filters, words", [({"wheel_type": "omni"}, "mecanum"), ({"maker": "nexs"}, "'nexus'")])
def test_parts_of_an_unknown_type_or_maker_are_refused(filters, words):
    with pytest.raises(UnknownNameError, match=words):
        parts(**filters)


@pytest.mark.parametrize(
    "text, unit, ends",
    [
        ("40..110 mm", "m", (0.04, 0.11)),
        ("40 mm..11cm", "m", (0.04, 0.11)),
        ("1.5 .. 4 in", "m", (0.0381, 0.1016)),
        ("40 mm..", "m", (0.04, math.inf)),
        ("..110 mm", "m", (0.0, 0.11)),
        ("100 mm", "m", (0.1, 0.1)),
        ("8..12", "", (8, 12)),
        ("12", "", (12, 12)),
    ],
)
def test_parse_range(text, unit, ends):
    assert parse_range(text, unit, "it") == pytest.approx(ends)


@pytest.mark.parametrize("text", ["", "..", "40..110", "40 kg..", "110..40 mm", "40 mm..nan mm", "1..2..3 mm", "40,5 mm"])
def test_parse_range_refuses(text):
    with pytest.raises(DesignError):
        parse_range(text, "m", "diameter")


def test_parts_text_has_a_line_a_part_and_dashes_for_the_unpublished():
    lines = parts_text(parts()).splitlines()
    assert [line.split()[0] for line in lines[2:-2]] == list(catalogue())
    row = next(line.split() for line in lines if line.startswith("nexus/14073"))
    assert row == ["nexus/14073", "dual-race", "127", "22", "19", "30", "0.48"]
    assert next(line.split() for line in lines if line.startswith("nexus/NW152A"))[1:] == ["-", "152", "-", "-", "100", "-"]
    assert parts_text(()) == "No part of the catalogue fits."


@pytest.mark.parametrize("name", catalogue())
def test_part_text_numbers_every_source_and_ends_in_lines_for_a_design_file(name):
    text = part_text(part(name))
    for read in part(name).sources.values():
        for address in read:
            assert text.count(address) == 1
    snippet = text[text.index("[wheels.omni]") :].removeprefix("[wheels.omni]\n")
    filled = "\n".join(f"{key} = {value}" for key, value in ADDED.items() if f"# {key} = " in snippet)
    if part(name).type is None:
        filled = 'type = "ideal"'
    assert parse_design(DESIGN.format(keys=f"{snippet}\n{filled}")).wheels[0].radius == part(name).radius


@pytest.mark.parametrize("name", catalogue())
def test_part_as_dict_holds_plain_types(name):
    import json

    told = json.loads(json.dumps(part(name).as_dict(), allow_nan=False))
    assert told == part(name).as_dict() and told["radius_m"] == part(name).radius
    assert told["missing"] == list(part(name).missing)
