"""
Exact modal response of an aircraft rolling over a runway profile.

Any consistent unit system will do; the 1980 report's is lbf, in, s. Start at `simulate`.
"""

from ._core import InputError, NumericalError, __version__
from .aircraft import Aircraft, Gear, equivalent_stiffness, f4e, single_dof
from .ensemble import Ensemble, Estimate, simulate_many
from .extremes import Extremes, Section
from .modes import Modes
from .monte_carlo import monte_carlo
from .profile import Profile
from .profile_csv import read_csv, write_csv
from .profile_erd import read_erd, write_erd
from .response import Response
from .roughness import Roughness
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
    "Roughness",
    "Section",
    "Sweep",
    "Units",
    "WorstSpeed",
    "__version__",
    "equivalent_stiffness",
    "f4e",
    "knots",
    "monte_carlo",
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
