"""
The 1980 report, recomputed: its tables, its figures and what it says of them.

R. R. Gajewski, *Modal analysis for aircraft response to runway surface roughness*, USAF Academy,
1980. Printed values stand in `tables`, the runs behind the figures in `runs`, the report's
statements with what was measured for each in `statements`. ``python -m runway_modal.report1980``
prints the full-mat comparison; `write_page` writes everything as one page.
"""

from .command import main
from .comparison import lines
from .page import write_page
from .runs import after_over_on, full_mat

__all__ = ["after_over_on", "full_mat", "lines", "main", "write_page"]
