"""What went in, and where each number comes from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Origin = Literal["printed", "published", "inferred"]


@dataclass(frozen=True, slots=True)
class Input:
    """A number or a rule that went in."""

    what: str
    value: str
    origin: Origin
    source: str


INPUTS = (
    Input("Mass, inertias, arms", "Table 1", "printed", "Section IV.2"),
    Input("Gravity", "386.0886 in/s²", "published", "standard gravity, 9.80665 m/s²"),
    Input("Gear stiffness", "Table 2; 8081 and 1508 lbf/in", "printed", "Sections IV.2, IV.6"),
    Input("Damping ratio, every mode", "1 %", "printed", "Sections IV.5, IV.6"),
    Input("Damping ratio over spalls", "1 %", "inferred", "as over the mats"),
    Input("Gear stiffness over spalls", "Table 3's", "inferred", "the text names none"),
    Input("Bounce model", "145.5 lbf·s²/in; 12.016 and 11.328 rad/s", "printed", "Section IV.4"),
    Input(
        "Bounce model's load beside one main gear's",
        "half",
        "inferred",
        "Eq. 16 has the whole weight; the scales of Figures 4 to 6 are lost",
    ),
    Input("Speed over mats, over spalls", "20 kt, 10 kt", "printed", "Sections IV.5 to IV.7"),
    Input("Mat thickness", "1.5 in", "published", "AM-2 matting, UFC 3-270-07"),
    Input("Full mat, length", "77.5 ft", "published", "crater cover, UFC 3-270-07"),
    Input("Full mat, ramps", "12 in", "inferred", "Figure 7 is lost"),
    Input(
        "Half mat, length and edges",
        "45 ft, sharp",
        "inferred",
        "Figure 3 is lost; chosen for the fourth minimum to be the first to unload",
    ),
    Input("Spall, length", "2 ft", "printed", "Section IV.7"),
    Input("Spall, depth and edges", "1.5 in, sharp", "inferred", "Figure 13 is lost"),
    Input(
        "Double spall, spacing",
        "4 ft from leading edge to leading edge",
        "inferred",
        "Figure 13 is lost",
    ),
    Input("Strut and tire stiffness at static", "Table 2", "printed", "Section IV.2"),
    Input(
        "Gas law and damper of the nonlinear reference",
        "isothermal; 1 % of critical",
        "inferred",
        "calibrated on the report's stiffnesses over the full mat; no F-4 strut drawing is public",
    ),
)
