"""Study files to studies."""

from __future__ import annotations

import functools
import math
import os
import re
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import BaseModel, ConfigDict, Field, PlainValidator, create_model

from spheredrive.errors import DesignError, InputError, did_you_mean
from spheredrive.io.catalogue import catalogue
from spheredrive.io.design_file import parse_design
from spheredrive.io.design_path import DesignPath, resolve
from spheredrive.io.motion_file import load_motion
from spheredrive.io.problems import Problems, check_version, validated
from spheredrive.io.quantity import NUMBER, parse, parse_list
from spheredrive.io.readers import read_quantity, read_version, read_word
from spheredrive.io.schema import model_of
from spheredrive.io.study import GIVEN, Algorithm, Constraint, Metric, Objective, Parameter, Sampling, Study
from spheredrive.io.toml_file import TomlFile, parse_toml, read_toml

# Values of one axis, and points of one study, at most.
LONGEST_AXIS = 100_000
MOST_POINTS = 10**9
MOST_PARAMETERS = 100

_QUANTITY = re.compile(rf"\s*({NUMBER})\s*(\S.*)?")
_RELATION = re.compile(r"\s*(>=|<=)\s*(.*)", re.DOTALL)
_SPEED = {"unit": "rad/s", "sign": "any"}
_PRICE = {"unit": "", "sign": "non-negative"}


class Law(NamedTuple):
    """A distribution as a study writes it: its numbers by name, and what they must be."""

    numbers: tuple[str, ...]
    rule: str
    holds: Any


# A tolerance is about the design's own value.
LAWS = {
    "uniform": Law(("from", "to"), "runs from a smaller to a larger number", lambda a, b: a < b),
    "normal": Law(("mean", "standard deviation"), "has a standard deviation above zero", lambda a, b: b > 0),
    "triangular": Law(("from", "most likely", "to"), "rises from least to largest number", lambda a, b, c: a <= b <= c > a),
}


def load_study(path: str | os.PathLike, metrics: Mapping[str, Metric]) -> Study:
    """The study in the TOML file at ``path``; ``metrics`` are those that there are, by name.

    Raises ``InputError`` with the place of the first thing in the file that is wrong, the rule it breaks and the nearest
    valid word.
    """
    return _study(read_toml(path), Path(path).parent, metrics)


def parse_study(
    text: str, metrics: Mapping[str, Metric], path: str = "study.toml", folder: str | os.PathLike | None = None
) -> Study:
    """The study in ``text``; messages call it ``path``, and files it names are sought in ``folder``, else beside ``path``."""
    return _study(parse_toml(text, path), Path(path).parent if folder is None else Path(folder), metrics)


@functools.lru_cache(maxsize=1)
def study_model() -> type[BaseModel]:
    """The model of a study file: its tables; what stands in them is read with the design at hand."""
    text = PlainValidator(functools.partial(read_word, choices=()))
    fields: dict[str, Any] = {
        "schema_version": (_annotated(PlainValidator(read_version)), Field(..., description="version of this file format")),
        "design": (_annotated(text), Field(..., description="design file, beside this file")),
        "motion": (_annotated(text), Field(None, description="motion file, where a metric needs one")),
        "speeds": (Any, Field(None, description="of the wheels, for vibration metrics; rad/s where numbers are bare")),
        "metrics": (list[_annotated(text)], Field([], description="what is wanted of each design")),
        "parameters": (dict[str, Any], Field(..., description="what is varied: paths into the design")),
        "sampling": (model_of(Sampling), Field(None, description="how points are taken; a grid if absent")),
        "objectives": (dict[str, Any], Field(None, description='metrics to make as large ("max") or small ("min") as can be')),
        "constraints": (dict[str, Any], Field(None, description='bounds on metrics, such as ">= 5 mm"')),
        "algorithm": (model_of(Algorithm), Field(None, description="how the best design is sought")),
        "prices": (dict[str, Any], Field(None, description="of parts of the catalogue and wheel models, all in one currency")),
    }
    return create_model("StudyFile", __config__=ConfigDict(extra="forbid", frozen=True), **fields)


def _annotated(validator: PlainValidator) -> Any:
    from typing import Annotated

    return Annotated[Any, validator]


def _study(document: TomlFile, folder: Path, metrics: Mapping[str, Metric]) -> Study:
    problems = Problems(document)
    check_version(document, problems)
    content = validated(study_model(), document.data, problems)
    base = design = motion = None
    with problems.under("design"):
        base = _beside(folder, content.design, read_toml)
        design = parse_design(base.text, base.path, folder=Path(base.path).parent)
    problems.raise_first()
    assert base is not None and design is not None, "a design was refused without a reason"
    if content.motion is not None:
        with problems.under("motion"):
            motion = _beside(folder, content.motion, load_motion)
    speeds: tuple[float, ...] = ()
    if content.speeds is not None:
        with problems.under("speeds"):
            speeds = _speeds(content.speeds)
    sampling = Sampling(**_given(content.sampling))
    # Where a best design is sought, a range needs no count.
    parameters = _parameters(content.parameters, base.data, sampling, bool(content.objectives), problems)
    _check_sampling(sampling, parameters, problems)
    names = _metric_names(content.metrics, metrics, motion, speeds, problems)
    objectives = _objectives(content.objectives or {}, metrics, problems)
    constraints = _constraints(content.constraints or {}, metrics, problems)
    prices = _prices(content.prices or {}, base.data, problems)
    problems.raise_first()
    return Study(
        design=design,
        data=base.data,
        folder=str(Path(base.path).parent.resolve()),
        metrics=names,
        parameters=parameters,
        sampling=sampling,
        motion=motion,
        speeds=speeds,
        objectives=objectives,
        constraints=constraints,
        algorithm=None if content.algorithm is None else Algorithm(**_given(content.algorithm)),
        prices=prices,
        source=document.text,
        path=document.path,
    )


def _given(content: Any) -> dict[str, Any]:
    return {} if content is None else {key: getattr(content, key) for key in content.model_fields_set}


def _beside(folder: Path, name: str, read: Any) -> Any:
    """What ``read`` makes of a file named in the study; where it is not there, the study is at fault."""
    try:
        return read(folder / name)
    except InputError as error:
        if error.place is not None:
            raise
        raise DesignError(f"{error.path!r}: {error.rule}") from None


def _speeds(value: Any) -> tuple[float, ...]:
    if isinstance(value, str):
        return tuple(parse_list(value, "rad/s", "speeds"))
    if not isinstance(value, list):
        return (read_quantity(value, _SPEED, (), "speeds"),)
    return read_quantity(value, _SPEED, (None,), "speeds")


def _parameters(tables: Mapping[str, Any], data, sampling: Sampling, sought: bool, problems: Problems) -> tuple[Parameter, ...]:
    found: list[Parameter] = []
    if not 1 <= len(tables) <= MOST_PARAMETERS:
        problems.add(("parameters",), f"takes from one to {MOST_PARAMETERS} paths into the design")
        return ()
    for text, value in tables.items():
        try:
            path = resolve(text, data)
            _refuse_overlap(path, found)
        except DesignError as error:
            problems.add(("parameters", text), error.rule, "key")
            continue
        with problems.under("parameters", text):
            found.append(_parameter(path, value, sampling.method, sought))
    return tuple(found)


def _refuse_overlap(path: DesignPath, others: list[Parameter]) -> None:
    for other in others:
        for a in path.places:
            for b in other.path.places:
                if a[: len(b)] == b[: len(a)]:
                    raise DesignError(f"writes where {other.name} does; keep one of the two")


def _parameter(path: DesignPath, value: Any, method: str, sought: bool) -> Parameter:
    if not isinstance(value, dict):
        values = value if isinstance(value, list) and not _is_one(path, value) else [value]
        return _listed(path, values)
    if not path.numeric:
        raise DesignError("takes a list of values: it is no single number")
    key, *more = value
    if key in LAWS or key == "tolerance":
        if more:
            raise DesignError(f"takes {key} alone, not {more[0][:60]!r} beside it", (more[0],))
        if method in GIVEN:
            raise DesignError(
                f'a {method} takes values; for a distribution write method = "random", "latin-hypercube" or "sobol"', (key,)
            )
        return _distributed(path, key, value[key])
    return _ranged(path, value, method in GIVEN and not sought)


def _is_one(path: DesignPath, value: list) -> bool:
    """Whether a list is one value of a vector, not a list of values."""
    return not path.numeric and not (value and isinstance(value[0], list)) and _takes_lists(path)


def _takes_lists(path: DesignPath) -> bool:
    return bool(path.meta.get("shape")) or ("inertia" in path.meta)


def _listed(path: DesignPath, values: list[Any]) -> Parameter:
    if not 1 <= len(values) <= LONGEST_AXIS:
        raise DesignError(f"takes from one to {LONGEST_AXIS} values")
    read: dict[Any, None] = {}
    for i, value in enumerate(values):
        try:
            number = path.read(value)
        except DesignError as error:
            raise error.under(i) if len(values) > 1 else error from None
        if number in read:
            raise DesignError("is given twice", (i,))
        read[number] = None
    if path.numeric:
        return Parameter(path, "values", tuple(map(float, read)))
    return Parameter(path, "values", choices=tuple(read))


def _ranged(path: DesignPath, table: dict[str, Any], counted: bool) -> Parameter:
    choices = ("from", "to", "count", *LAWS, "tolerance")
    for key in table:
        if key not in ("from", "to", "count"):
            raise DesignError(f"unknown key {key[:60]!r}{did_you_mean(key[:60], choices)}", (key,))
    for key in ("from", "to"):
        if key not in table:
            raise DesignError(f"lacks the key {key}; a range has from, to and count")
    ends = tuple(float(_under(path, table[key], key)) for key in ("from", "to"))
    if "count" not in table:
        if counted:
            raise DesignError("lacks the key count: a grid or list takes so many values from one end to the other")
        if not ends[0] < ends[1]:
            raise DesignError("runs from a smaller to a larger number", ("to",))
        return Parameter(path, "uniform", ends)
    count = table["count"]
    if isinstance(count, bool) or not isinstance(count, int) or not 2 <= count <= LONGEST_AXIS:
        raise DesignError(f"takes a whole number from 2 to {LONGEST_AXIS}", ("count",))
    if ends[0] == ends[1]:
        raise DesignError("is where the range begins; its values would be the same", ("to",))
    return Parameter(path, "values", _between(path, table["from"], table["to"], count))


def _under(path: DesignPath, value: Any, key: str) -> Any:
    try:
        return path.read(value)
    except DesignError as error:
        raise error.under(key) from None


def _between(path: DesignPath, first: Any, last: Any, count: int) -> tuple[float, ...]:
    """``count`` values, evenly from ``first`` to ``last``, each the same double as if it had been typed.

    Steps are taken as fractions of the numbers in the unit that both are written in: so a range that is refined keeps the
    values it had, to the last bit.
    """
    texts = [_QUANTITY.fullmatch(v) if isinstance(v, str) else _QUANTITY.fullmatch(repr(v)) for v in (first, last)]
    units = [t and (t[2] or "").strip() for t in texts]
    if None in texts or units[0] != units[1]:
        ends = [Fraction(path.read(v)) for v in (first, last)]
        unit = None
    else:
        ends, unit = [Fraction(t[1]) for t in texts], units[0]  # type: ignore[index]
    values = []
    for k in range(count):
        number = ends[0] + (ends[1] - ends[0]) * Fraction(k, count - 1)
        if path.whole and number.denominator != 1:
            raise DesignError(f"gives {float(number):g}, but takes whole numbers", ("count",))
        values.append(float(number) if not unit else parse(f"{float(number)!r} {unit}", path.unit))
    return tuple(values)


def _distributed(path: DesignPath, key: str, value: Any) -> Parameter:
    if path.whole:
        raise DesignError("counts whole things; give a list, or from and to")
    if key == "tolerance":
        own = set(path.base)
        if len(own) > 1 or None in own:
            raise DesignError("has no single value in the design to be off from; give normal or uniform", (key,))
        # An angle's tolerance is read without the sign that its middle may have.
        width = float(read_quantity(value, {**path.meta, "sign": "positive"}, (), key)) if not isinstance(value, list) else None
        if width is None:
            raise DesignError("takes one number: the largest deviation to either side", (key,))
        return Parameter(path, "tolerance", (float(own.pop()), width))
    law = LAWS[key]
    if not isinstance(value, list) or len(value) != len(law.numbers):
        raise DesignError(f"takes {len(law.numbers)} numbers: {', '.join(law.numbers)}", (key,))
    loose = {**path.meta, "sign": "any"}
    try:
        numbers = tuple(float(read_quantity(v, loose, (), key)) for v in value)
    except DesignError as error:
        raise error.under(key) from None
    if not law.holds(*numbers):
        raise DesignError(law.rule, (key,))
    return Parameter(path, key, numbers)


def _check_sampling(sampling: Sampling, parameters: tuple[Parameter, ...], problems: Problems) -> None:
    place = ("sampling", "size") if sampling.size is not None else ("sampling",)
    method, lengths = sampling.method, [len(p.values) for p in parameters if p.law == "values"]
    if method not in GIVEN:
        if sampling.size is None:
            problems.add(place, f'lacks the key size: method = "{method}" takes so many points')
        return
    if sampling.size is not None:
        problems.add(place, f"is settled by the values of a {method}; leave it out")
    if method == "grid" and math.prod(lengths) > MOST_POINTS:
        problems.add(("parameters",), f"make a grid of {math.prod(lengths):.3g} points; {MOST_POINTS:.0e} is the most")
    if method == "list" and len(set(lengths) - {1}) > 1:
        problems.add(("parameters",), "a list takes equally many values of each parameter, or one for all points")


def _metric_names(names: list[str], metrics, motion, speeds, problems: Problems) -> tuple[str, ...]:
    for i, name in enumerate(names):
        with problems.under("metrics", i):
            metric = _metric(name, metrics)
            if name in names[:i]:
                raise DesignError(f"{name!r} is named twice")
            for need, given in (("motion", motion is not None), ("speeds", bool(speeds))):
                if need in metric.needs and not given:
                    raise DesignError(f"{name} needs {need}; add the key {need} to this file")
    return tuple(names)


def _metric(name: str, metrics: Mapping[str, Metric]) -> Metric:
    if name not in metrics:
        raise DesignError(f"there is no metric {name[:60]!r}{did_you_mean(name[:60], metrics, limit=40)}")
    return metrics[name]


def _prices(table: Mapping[str, Any], data, problems: Problems) -> tuple[tuple[str, float], ...]:
    named = (*data["wheels"], *catalogue())
    found = []
    for name, value in table.items():
        with problems.under("prices", name):
            if name not in named:
                raise DesignError(f"there is no such part or wheel model{did_you_mean(name[:60], named)}")
            found.append((name, float(read_quantity(value, _PRICE, (), name))))
    return tuple(found)


def _objectives(table: Mapping[str, Any], metrics, problems: Problems) -> tuple[Objective, ...]:
    found = []
    for name, sense in table.items():
        if name not in metrics:
            with problems.under("objectives", name):
                _metric(name, metrics)
        with problems.under("objectives", name):
            found.append(Objective(name, read_word(sense, ("min", "max"))))
    return tuple(found)


def _constraints(table: Mapping[str, Any], metrics, problems: Problems) -> tuple[Constraint, ...]:
    found = []
    for name, text in table.items():
        with problems.under("constraints", name):
            metric = _metric(name, metrics)
            bound = _RELATION.fullmatch(text) if isinstance(text, str) else None
            if bound is None:
                raise DesignError(f'takes text such as ">= {"5 mm" if metric.unit == "m" else f"2 {metric.unit}".strip()}"')
            number = bound[2].strip()
            bare = float(number) if not metric.unit and re.fullmatch(NUMBER, number) else number
            found.append(Constraint(name, bound[1], parse(bare, metric.unit, name)))
    return tuple(found)
