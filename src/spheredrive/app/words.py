"""Answers as text of the page: verdict, numbers, matrices and findings in HTML. Everything that a file can hold is escaped."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from spheredrive.app.answers import Answers
from spheredrive.checking import Finding
from spheredrive.errors import InputError, SpheredriveError
from spheredrive.scene import colours
from spheredrive.summary.design import singularity_text

if TYPE_CHECKING:
    import xarray

# A matrix of more columns is cut: nobody reads it in a panel.
COLUMNS = 8
_TINTS = {colours.WORKS: "#eef7f3", colours.WARNING: "#fdf3e1", colours.FAILURE: "#fbeeed", colours.GREY: "#f5f4f0"}
_SEVERITY = {"failure": colours.FAILURE, "warning": colours.WARNING, "note": "#00558c"}
_TABLE = "border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:13px;line-height:1.45;width:100%"


def block(content: str) -> str:
    """HTML for the panel, in the page's type."""
    return f'<div style="padding:2px 10px 6px;font-size:13px;line-height:1.45;overflow-wrap:anywhere">{content}</div>'


def strip(text: str, colour: str, detail: str = "") -> str:
    """A sentence with a coloured edge."""
    more = f'<div style="font-weight:400">{escape(detail)}</div>' if detail else ""
    style = f"border-left:5px solid {colour};background:{_TINTS.get(colour, '#fff')};padding:5px 9px;font-weight:600;color:#222"
    return f'<div style="{style}">{escape(text)}{more}</div>'


def verdict(answers: Answers) -> tuple[str, str, str]:
    """The sentence over everything, its colour and what it rests on."""
    found = answers.check
    if not found.works:
        worst = next(finding for finding in found.findings if finding.severity == "failure")
        return "The design does not work.", colours.FAILURE, worst.message
    if answers.nearness > 0:
        return "The design works, but is close to a singularity.", colours.WARNING, f"Nearest: {singularity_text(found)}."
    return "The design works.", colours.WORKS, ""


def status_html(answers: Answers, refusal: str = "") -> str:
    """Verdict and the numbers that a designer watches; over them the sentence that refused the last change."""
    text, colour, detail = verdict(answers)
    found = answers.check
    low, high = found.effectiveness
    upper = "without limit" if math.isinf(high) else f"{high:.3f}"
    rows = [
        ("Effectiveness ξ", f"{low:.3f} to {upper}"),
        ("Isotropy", f"{found.isotropy:.3f}"),
        ("Condition number", "infinite" if math.isinf(found.condition_number) else f"{found.condition_number:.3f}"),
        ("Nearest singularity", singularity_text(found)),
        ("Contact states", str(found.contact_state_count)),
    ]
    refused = (
        strip("Not changed: the picture shows the last machine that can be built.", colours.FAILURE, refusal) if refusal else ""
    )
    return block(refused + strip(text, colour, detail) + pairs(rows))


def brief_html(answers: Answers, refusal: str = "") -> str:
    """The status in two lines, for windows in which nothing else of it can be seen."""
    low, high = answers.check.effectiveness
    upper = "∞" if math.isinf(high) else f"{high:.3f}"
    text, colour, _ = verdict(answers)
    if refusal:
        return block(strip("Not changed.", colours.FAILURE, refusal))
    return block(strip(text, colour, f"ξ {low:.3f} to {upper}, isotropy {answers.check.isotropy:.3f}"))


def motion_html(answers: Answers) -> str:
    """What the sphere does at the wheel speeds set."""
    if answers.angular_velocity is None:
        return block(f"<p>{escape(answers.no_motion)}</p>")
    Omega = answers.angular_velocity
    rows = [("Ω (rad/s)", "  ".join(_fixed(x, 4) for x in Omega)), ("|Ω| (rad/s)", _fixed(float(np.linalg.norm(Omega)), 4))]
    if answers.effectiveness is not None:
        rows.append(("ξ at these speeds", _fixed(answers.effectiveness, 4)))
    if answers.slip is not None:
        rows.append(("Slip S of all wheels", "infinite" if math.isinf(answers.slip) else _fixed(answers.slip, 4)))
    return block(pairs(rows))


def jacobian_html(answers: Answers) -> str:
    """J and its inverse as tables."""
    found = answers.check
    if found.jacobian is None:
        first = "<p>There is no Jacobian: the wheels do not determine the sphere's rotation.</p>"
    else:
        first = _matrix("Jacobian J, Ω = J ω", found.jacobian, "xyz")
    names = [str(i + 1) for i in range(len(found.inverse_jacobian))]
    return block(first + _matrix("Inverse, ω = J⁻¹ Ω", found.inverse_jacobian, names, "xyz"))


def findings_html(findings: Sequence[Finding], notes: Sequence[str] = ()) -> str:
    """Findings, the worst first, and remarks on the picture."""
    order = ("failure", "warning", "note")
    parts = [
        f'<p style="margin:3px 0"><b style="color:{_SEVERITY[f.severity]}">{f.severity}</b> {escape(f.message)}</p>'
        for f in sorted(findings, key=lambda f: order.index(f.severity))
    ]
    parts += [f'<p style="margin:3px 0;color:#555">{escape(note)}</p>' for note in notes]
    return block("".join(parts) or "<p>Nothing to remark.</p>")


def run_title(run: xarray.Dataset) -> str:
    """A run in a sentence: model, samples, how it ended."""
    ended = "" if int(run.attrs["completed"]) else f" It ended early: {run.attrs.get('reason', 'no reason is given')}"
    time = run["time"].values
    span = f"{float(time[-1]) - float(time[0]):.4g} s" if len(time) else "no time"
    return f"A run of the {escape(str(run.attrs['model']))} model over {span}, {len(time)} samples.{escape(ended)}"


def key_html() -> str:
    """What the signs of the picture mean."""
    rows = [
        (colours.INK, "arrow on the sphere: its angular velocity Ω"),
        (colours.GREY, "arrow on an axle, in the wheel's colour: its angular velocity"),
        (colours.GREY, "arrow at a contact, in the wheel's colour: drive direction"),
        (colours.FAILURE, "dot: a contact that carries the sphere"),
        (colours.LIGHT, "small dot: a contact that is open"),
        (colours.MARK, "a mark on the sphere, and its path along a run"),
    ]
    return block("".join(f'<div><span style="color:{colour}">●</span> {text}</div>' for colour, text in rows))


def error_html(error: SpheredriveError | str) -> str:
    """What is wrong with a file or a value, as a sentence with its place; nothing for ""."""
    if not error:
        return ""
    if isinstance(error, InputError) and error.place is not None:
        place = f"{error.place.path}, line {error.place.line}"
        line = f'<pre style="margin:3px 0;white-space:pre-wrap">{escape(error.place.text)}</pre>' if error.place.text else ""
        return block(strip(error.rule, colours.FAILURE, place) + line)
    return block(strip(str(error), colours.FAILURE))


def pairs(rows: Sequence[tuple[str, str]]) -> str:
    """Names and their values as a table."""
    cells = "".join(
        f'<tr><td style="padding:1px 8px 1px 0;color:#555;white-space:nowrap">{escape(name)}</td>'
        f'<td style="padding:1px 0;white-space:pre-wrap">{escape(value)}</td></tr>'
        for name, value in rows
    )
    return f'<table style="{_TABLE};margin-top:4px">{cells}</table>'


def _matrix(title: str, matrix: np.ndarray, rows: Sequence[str], columns: Sequence[str] = ()) -> str:
    shown = matrix[:40, :COLUMNS]
    names = list(columns) or [str(i + 1) for i in range(shown.shape[1])]
    head = "".join(f'<th style="text-align:right;font-weight:400;color:#777;padding-left:8px">{name}</th>' for name in names)
    body = "".join(
        f'<tr><td style="color:#777">{name}</td>'
        + "".join(f'<td style="text-align:right;padding-left:8px;white-space:nowrap">{_fixed(x, 4)}</td>' for x in row)
        + "</tr>"
        for name, row in zip(rows, shown, strict=False)
    )
    cut = "<div>… and more</div>" if shown.shape != matrix.shape else ""
    return (
        f'<div style="margin-top:4px">{escape(title)}</div><div style="overflow-x:auto"><table style="{_TABLE};width:auto">'
        f"<tr><td></td>{head}</tr>{body}</table></div>{cut}"
    )


def _fixed(number: float, digits: int) -> str:
    return f"{round(float(number), digits) + 0.0:.{digits}f}".replace("-", "−")
