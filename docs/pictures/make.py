"""Draw the pictures of the documentation with the report's own figures: python docs/pictures/make.py"""

from pathlib import Path

import spheredrive as sd
from spheredrive.report.figures.effectiveness import effectiveness_figure
from spheredrive.report.figures.layout import layout_figure
from spheredrive.report.figures.projection import FROM_SIDE

HERE = Path(__file__).parent

design = sd.load_design(sd.design_path("atlas-dual-race"))
for name, figure in (("layout", layout_figure(design, FROM_SIDE)), ("effectiveness", effectiveness_figure(design))):
    figure.savefig(HERE / f"{name}.png", dpi=110, metadata={"Software": None})
