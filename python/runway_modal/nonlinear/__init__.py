"""
Nonlinear reference: gas struts, tires and gears that leave the runway (extra ``taxi``).

A model of the class of TAXI (Gerardi and Lohwasser, AFWL-TR-73-109, 1974), against which the
1980 report calibrates its linear one. The body bounces, pitches and rolls; each gear is a strut
in series with a tire that never pulls on the runway. Runs need scipy.

`springs` and `series` hold the force laws, `motion` the equations of motion, `simulate` the
integration from break to break.
"""

from .aircraft import Aircraft, Gear, f4e
from .response import Response
from .simulate import simulate
from .springs import GasSpring, LinearSpring, Orifice

__all__ = [
    "Aircraft",
    "GasSpring",
    "Gear",
    "LinearSpring",
    "Orifice",
    "Response",
    "f4e",
    "simulate",
]
