"""What the report prints, as data: nothing here is computed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Stiffness = Literal["static", "equivalent"]

#: Damping ratio of every mode [-] (Sections IV.5 and IV.6).
DAMPING_RATIO = 0.01

#: Speeds over mats and over spalls [kt] (Sections IV.5 to IV.7).
MAT_KNOTS, SPALL_KNOTS = 20.0, 10.0


@dataclass(frozen=True, slots=True)
class PrintedModes:
    """Modes as a table of the report prints them: pitch and bounce modes, then roll."""

    title: str
    stiffness: Stiffness
    #: Circular frequencies [rad/s].
    omega: tuple[float, float, float]
    #: Shapes {bounce, pitch, roll}, one a mode; Mode 2 has the opposite sign to ours.
    shapes: tuple[tuple[float, float, float], ...]


@dataclass(frozen=True, slots=True)
class PrintedGear:
    """Stiffness of one kind of gear [lbf/in], as Table 2 prints it."""

    name: str
    strut: float
    tire: float
    series: float


@dataclass(frozen=True, slots=True)
class PrintedRange:
    """Stiffness of one kind of gear over TAXI's full-mat run [lbf/in] (Section IV.6)."""

    name: str
    low: float
    high: float
    #: By Eq. 22.
    equivalent: float


#: Symbol, value and unit, in the table's order.
TABLE_1 = (
    ("M_CG", 145.5, "lbf·s²/in"),
    ("I_P", 1.92e6, "lbf·s²·in"),
    ("I_R", 6.56e5, "lbf·s²·in"),
    ("D_L = D_R", 109.25, "in"),
    ("D_N", 234.9, "in"),
    ("D_M", 44.35, "in"),
)

TABLE_2 = (
    PrintedGear("main", 27809.0, 13530.0, 9102.0),
    PrintedGear("nose", 1662.0, 15600.0, 1502.0),
)

TABLE_3 = PrintedModes(
    "Table 3: slope of the air curve at static equilibrium",
    "static",
    (7.271, 12.016, 18.198),
    ((0.025931, 0.000685, 0.0), (-0.078743, 0.000226, 0.0), (0.0, 0.0, 0.001235)),
)

TABLE_4 = PrintedModes(
    "Table 4: equivalent stiffness, Eq. 22",
    "equivalent",
    (7.282, 11.328, 17.148),
    ((0.025052, 0.000688, 0.0), (-0.079027, 0.000218, 0.0), (0.0, 0.0, 0.001235)),
)

#: Nodes of Table 3's first two modes [in], forward positive (Section IV.3).
NODES = (-37.9, 348.4)

TAXI_STIFFNESS = (
    PrintedRange("main", 4733.0, 11362.0, 8081.0),
    PrintedRange("nose", 965.0, 2662.0, 1508.0),
)
