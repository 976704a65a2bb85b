"""Directives ``metrics`` and ``run-variables``: what a study can ask for and what a run holds, from the program itself."""

from __future__ import annotations

from sphinx.util.docutils import SphinxDirective

import spheredrive as sd


def metrics_table() -> str:
    """Every metric with its unit, in Markdown."""
    from spheredrive.studies.sweep.metrics import metrics

    rows = [(f"`{m.name}`", m.long_name, m.unit, ", ".join(m.needs)) for m in metrics().values()]
    return _table(("metric", "meaning", "unit", "needs"), rows)


def variables_table() -> str:
    """Every variable of a run of either model, in Markdown."""
    from spheredrive.motion import Motion, Series

    design = sd.load_design(sd.design_path("ballbot"))
    motion = Motion("wheel-speed", Series((0.0,), ((1.0, 2.0, 3.0),)), duration=0.01)
    runs = {model: sd.simulate(design, motion, model).data_vars for model in ("rolling", "compliant")}
    rows = []
    for name in dict.fromkeys([*runs["rolling"], *runs["compliant"]]):
        models = [model for model, found in runs.items() if name in found]
        variable = runs[models[0]][name]
        unit = variable.attrs["units"].removeprefix("1")
        both = "both" if len(models) == 2 else models[0]
        rows.append((f"`{name}`", variable.attrs["long_name"], unit, ", ".join(variable.dims), both))
    return _table(("variable", "meaning", "unit", "dimensions", "model"), rows)


def _table(head, rows) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell).replace("|", "\\|") for cell in line) + " |" for line in lines)


class Metrics(SphinxDirective):
    """``metrics``."""

    def run(self):
        """The table."""
        return self.parse_text_to_nodes(metrics_table())


class RunVariables(SphinxDirective):
    """``run-variables``."""

    def run(self):
        """The table."""
        return self.parse_text_to_nodes(variables_table())


def setup(app):
    """Register the directives."""
    app.add_directive("metrics", Metrics)
    app.add_directive("run-variables", RunVariables)
    return {"parallel_read_safe": True}
