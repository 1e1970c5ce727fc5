"""
Exact modal response of an aircraft rolling over a runway profile.

Any consistent unit system; the report's is lbf, in, s. See `simulate`.
"""

from ._core import InputError, NumericalError
from .aircraft import Aircraft, Gear, equivalent_stiffness, f4e, single_dof
from .ensemble import Ensemble, Estimate, simulate_many
from .modes import Modes
from .profile import Profile
from .profile_csv import read_csv, write_csv
from .profile_erd import read_erd, write_erd
from .response import Extremes, Response
from .simulate import simulate
from .sweep import Sweep, WorstSpeed, sweep, worst_speed
from .units import Units, knots

__all__ = [
    "Aircraft",
    "Ensemble",
    "Estimate",
    "Extremes",
    "Gear",
    "InputError",
    "Modes",
    "NumericalError",
    "Profile",
    "Response",
    "Sweep",
    "Units",
    "WorstSpeed",
    "equivalent_stiffness",
    "f4e",
    "knots",
    "read_csv",
    "read_erd",
    "simulate",
    "simulate_many",
    "single_dof",
    "sweep",
    "worst_speed",
    "write_csv",
    "write_erd",
]
