"""Text for the terminal: designs and answers as tables a person can read."""

from spheredrive.summary.cells import degrees, full_turn, millimetres, table
from spheredrive.summary.compliant import compliant_text
from spheredrive.summary.design import check_text, design_table, singularity_text
from spheredrive.summary.run import preload_phrase, ratio, run_text
from spheredrive.summary.vibration import vibration_text

__all__ = [
    "check_text",
    "compliant_text",
    "degrees",
    "design_table",
    "full_turn",
    "millimetres",
    "preload_phrase",
    "ratio",
    "run_text",
    "singularity_text",
    "table",
    "vibration_text",
]
