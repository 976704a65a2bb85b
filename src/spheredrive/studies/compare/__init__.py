"""The same machine with different wheels, or several machines, side by side."""

from spheredrive.studies.compare.comparison import Comparison, Row, compare
from spheredrive.studies.compare.machines import Machine, machine, machines, with_part
from spheredrive.studies.compare.motions import motion_alike, speeds_alike

__all__ = ["Comparison", "Machine", "Row", "compare", "machine", "machines", "motion_alike", "speeds_alike", "with_part"]
