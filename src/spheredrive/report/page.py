"""The page: gathers tables, figures and sentences, and fills the template."""

from __future__ import annotations

import warnings
from dataclasses import replace
from importlib.resources import files
from typing import NamedTuple

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

import spheredrive
from spheredrive import kinematics
from spheredrive.checking import Check, check
from spheredrive.design import Design
from spheredrive.errors import NearSingularWarning, SpheredriveError
from spheredrive.kinematics import KinematicRun
from spheredrive.motion import Motion
from spheredrive.report import tables
from spheredrive.report.figures.contact_states import (
    contact_states_caption,
    contact_states_figure,
    contact_states_sentence,
)
from spheredrive.report.figures.effectiveness import effectiveness_caption, effectiveness_figure
from spheredrive.report.figures.layout import layout_caption, layout_figure
from spheredrive.report.figures.loads import (
    contact_force_caption,
    contact_force_figure,
    ledger_sentence,
    motor_caption,
    motor_figure,
    preload_sentence,
)
from spheredrive.report.figures.projection import FROM_ABOVE, FROM_SIDE
from spheredrive.report.figures.race_error import race_error_caption, race_error_figure
from spheredrive.report.figures.sphere_motion import sphere_motion_caption, sphere_motion_figure
from spheredrive.report.parts import Part, drawn, readable
from spheredrive.report.vibration import assessed, mean_speeds, vibration_parts
from spheredrive.scene.page import scene_frame, scene_html, script_hash
from spheredrive.simulation.dataset import labelled
from spheredrive.simulation.overview import Overview, overview
from spheredrive.simulation.rolling_run import RollingRun, Tolerance, run_rolling
from spheredrive.vibration.assessment.assess import Assessment

# A page shows no more than this many samples of a motion; every change of race is worked out whatever the rate.
SAMPLES = 200_000


class Page(NamedTuple):
    """A report as HTML text, and whether what it tells is a design that works."""

    html: str
    works: bool


class Dynamics(NamedTuple):
    """A motion followed by the rolling model."""

    run: RollingRun
    overview: Overview


def page(design: Design, motion: Motion | None = None, speeds=None) -> Page:
    """The whole report; the vibration at wheel ``speeds`` (n,), rad/s, or at the mean speeds of the motion."""
    result = check(design)
    if motion is not None:
        motion.check_wheel_count(design.wheel_count)
    dynamics = None if motion is None else _dynamics(design, motion)
    moved = dynamics.overview if isinstance(dynamics, Dynamics) else None
    shaken = _vibration(design, motion, dynamics, speeds)
    vibration = shaken if isinstance(shaken, Assessment) else None
    works = result.works and (moved is None or moved.works) and (vibration is None or vibration.works)
    template = _environment().from_string((files("spheredrive.report") / "report.html.j2").read_text(encoding="utf-8"))
    html = template.render(
        design=design,
        works=works,
        verdict=_verdict(result, moved, vibration),
        findings=[*result.findings, *(moved.findings if moved else ()), *(vibration.findings if vibration else ())],
        motion=motion,
        speeds=None if speeds is None else " ".join(f"{omega:.17g}" for omega in speeds),
        result=result,
        parts=[
            *_design_parts(design, result),
            *_motion_parts(design, motion, dynamics),
            *([] if shaken is None else vibration_parts(shaken, speeds is not None)),
        ],
        placements=tables.placement_rows(design),
        sections=[*tables.design_sections(design), *tables.wheel_sections(design)],
        omitted_models=max(0, len(tables.wheel_models(design)) - tables.MODELS_SHOWN),
        omitted_wheels=max(0, design.wheel_count - tables.WHEELS_SHOWN),
        assumptions=tables.assumptions(design),
        quality=tables.quality_rows(result),
        matrices=tables.matrices(result),
        scene=_scene(design, dynamics, motion, speeds),
        script_hash=script_hash(),
        version=spheredrive.__version__,
    )
    return Page(html, works)


class Scene(NamedTuple):
    """The machine in motion, as an element of the page, and what it shows."""

    frame: Markup
    caption: str


def _scene(design: Design, dynamics: Dynamics | str | None, motion: Motion | None, speeds) -> Scene:
    """The machine along its run, at its speeds, or with its wheels at 1 rad/s."""
    if isinstance(dynamics, Dynamics) and motion is not None:
        html = scene_html(design, labelled(design, motion, dynamics.run, Tolerance()))
        return Scene(Markup(scene_frame(readable(html), "The machine in motion")), "The machine along the motion.")
    html = scene_html(design, wheel_speed=speeds)
    which = "at 1 rad/s each" if speeds is None else "at the given speeds"
    return Scene(Markup(scene_frame(readable(html), "The machine in motion")), f"The machine with its wheels turning {which}.")


def _verdict(result: Check, moved: Overview | None, vibration: Assessment | None) -> str:
    if not result.works:
        return "The design does not work."
    if moved is not None and not moved.works:
        return "The layout works, but the design does not in this motion."
    if vibration is not None and not vibration.works:
        return "The layout works, but the design does not at these wheel speeds."
    return "The design works."


def _vibration(design: Design, motion: Motion | None, dynamics: Dynamics | str | None, speeds) -> Assessment | str | None:
    """The vibration at ``speeds`` or those of the motion, why it is not known, or None where no speeds are."""
    if speeds is None and motion is not None:
        speeds = mean_speeds(design, motion, dynamics.run if isinstance(dynamics, Dynamics) else None)
    return None if speeds is None else assessed(design, speeds)


def _environment() -> Environment:
    return Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, finalize=readable)


def _design_parts(design: Design, result: Check) -> list[Part]:
    views = [lambda view=view: layout_figure(design, view) for view in (FROM_ABOVE, FROM_SIDE)]
    parts = [
        drawn("layout", "Layout", layout_caption(design), *views),
        drawn(
            "effectiveness",
            "Effectiveness about every axis",
            effectiveness_caption(design),
            lambda: effectiveness_figure(design),
        ),
    ]
    sentence = contact_states_sentence(result)
    if sentence is not None:
        return [*parts, Part("states", "Contact states", sentence)]
    caption = contact_states_caption(result)
    return [*parts, drawn("states", "Contact states", caption, lambda: contact_states_figure(result))]


def _motion_parts(design: Design, motion: Motion | None, dynamics: Dynamics | str | None) -> list[Part]:
    if motion is None:
        return []
    if motion.kind == "wheel-torque" and isinstance(dynamics, Dynamics):
        run = dynamics.run
        sphere = drawn("motion", "Motion of the sphere", sphere_motion_caption(run), lambda: sphere_motion_figure(run))
        return [sphere, *_load_parts(dynamics)]
    return [*_kinematic_parts(design, motion), *_load_parts(dynamics)]


def _kinematic_parts(design: Design, motion: Motion) -> list[Part]:
    run = _run(design, motion)
    if isinstance(run, str):
        return [Part("motion", "Motion", run)]
    alternates = any(len(wheel.alternation) > 1 for wheel in design.wheels)
    differs = max(abs(run.error_angle).max(), abs(run.error_magnitude).max()) > 1e-12
    sphere = drawn("motion", "Motion of the sphere", sphere_motion_caption(run), lambda: sphere_motion_figure(run, not differs))
    if differs:
        error = drawn("error", "Error of the nominal Jacobian", race_error_caption(run), lambda: race_error_figure(run))
        return [error, sphere]
    why = (
        "The races of these wheels take turns, but along this motion all of them drive the sphere alike: the nominal Jacobian "
        "is exact, and there is no error to draw."
        if alternates
        else "No wheel of this design has races that take turns: the nominal Jacobian is exact, and there is no error to draw."
    )
    return [Part("error", "Error of the nominal Jacobian", why), sphere]


def _load_parts(dynamics: Dynamics | str | None) -> list[Part]:
    if not isinstance(dynamics, Dynamics):
        return [Part("loads", "Loads", f"The loads are not worked out: {dynamics}.")]
    run, moved = dynamics
    loads, sizing = moved.loads, tables.sizing_table(moved)
    assert loads is not None, "a run with samples has loads"
    return [
        drawn("motors", "Motors", motor_caption(loads), lambda: motor_figure(run, loads)),
        drawn("forces", "Contact forces", contact_force_caption(moved), lambda: contact_force_figure(run, loads)),
        Part("sizing", "What each wheel has to bear", f"{preload_sentence(moved)} {ledger_sentence(moved)}", table=sizing),
    ]


def _dynamics(design: Design, motion: Motion) -> Dynamics | str:
    """The motion followed by the rolling model, or the end of a sentence that says why it cannot be."""
    rate = min(motion.sample_rate, SAMPLES / motion.duration)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NearSingularWarning)
        try:
            run = run_rolling(design, replace(motion, sample_rate=rate))
        except SpheredriveError as error:
            return str(error)
    # A run that does not begin says nothing of the design.
    return Dynamics(run, overview(design, run)) if len(run.time) else run.reason


def _run(design: Design, motion: Motion) -> KinematicRun | str:
    """The motion followed by kinematics, or the sentence that says why it cannot be."""
    if motion.kind == "wheel-torque":
        return "The motion is given by wheel torques. Kinematics cannot follow it: it takes the dynamics to know the speeds."
    rate = min(motion.sample_rate, SAMPLES / motion.duration)
    with warnings.catch_warnings():
        # Near singularity is told by a finding on the page.
        warnings.simplefilter("ignore", NearSingularWarning)
        try:
            return kinematics.along(design, replace(motion, sample_rate=rate))
        except SpheredriveError as error:
            return f"The motion cannot be followed: {error}"
