from typing import final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Aircraft",
    "Course",
    "Gear",
    "Generator",
    "InputError",
    "Modes",
    "NumericalError",
    "Profile",
    "Run",
    "Spectrum",
    "__version__",
    "monte_carlo",
    "series",
    "simulate_many",
]

__version__: str

class InputError(ValueError): ...
class NumericalError(ArithmeticError): ...

def monte_carlo(
    modes: Modes,
    generator: Generator,
    first_run: int,
    runs: int,
    speed: list[float],
    stations: NDArray[np.float64],
    damping_input: bool,
    mask: bool,
) -> tuple[list[NDArray[np.float64]], list[tuple[int, str]]]: ...
def series(strut: float, tire: float) -> float: ...
def simulate_many(
    cases: list[tuple[Modes, NDArray[np.float64]]],
    elevations: NDArray[np.float64] | NDArray[np.float32],
    spacing: float,
    speed: list[float],
    damping_input: bool,
    mask: bool,
    between: bool = True,
) -> tuple[list[NDArray[np.float64]], list[tuple[int, str]]]: ...

@final
class Gear:
    def __new__(cls, name: str, x: float, y: float, stiffness: float, damping: float) -> Gear: ...

@final
class Aircraft:
    def __new__(
        cls,
        mass: float,
        pitch_inertia: float,
        roll_inertia: float,
        gravity: float,
        gears: list[Gear],
    ) -> Aircraft: ...
    def stiffness_matrix(self) -> NDArray[np.float64]: ...
    def damping_matrix(self) -> NDArray[np.float64]: ...
    def static_load(self) -> NDArray[np.float64]: ...
    def rank(self) -> int: ...

@final
class Modes:
    @staticmethod
    def natural(aircraft: Aircraft, damping_ratio: float | NDArray[np.float64] | None) -> Modes: ...
    @staticmethod
    def measured(
        aircraft: Aircraft,
        omega: NDArray[np.float64],
        damping_ratio: NDArray[np.float64],
        shapes: NDArray[np.float64],
        static_correction: bool,
    ) -> Modes: ...
    def omega(self) -> NDArray[np.float64]: ...
    def damping_ratio(self) -> NDArray[np.float64]: ...
    def shapes(self) -> NDArray[np.float64]: ...
    def node(self) -> NDArray[np.float64]: ...
    def damping_coupling(self) -> NDArray[np.float64]: ...

@final
class Profile:
    def __new__(cls, x: NDArray[np.float64], z: NDArray[np.float64]) -> Profile: ...
    @staticmethod
    def level() -> Profile: ...
    @staticmethod
    def one_minus_cosine(length: float, height: float, segments: int, start: float) -> Profile: ...
    def x(self) -> NDArray[np.float64]: ...
    def z(self) -> NDArray[np.float64]: ...
    def elevation(self, stations: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def shifted(self, dx: float) -> Profile: ...
    def sum(self, other: Profile) -> Profile: ...
    def footprint(self, length: float, tolerance: float) -> Profile: ...

@final
class Run:
    def __new__(
        cls, modes: Modes, profiles: list[Profile], speed: float, damping_input: bool
    ) -> Run: ...
    def speed(self) -> float: ...
    def sample(
        self, duration: float | None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...
    def states(
        self, times: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def read(
        self, quantity: str, stations: list[tuple[float, float]], times: NDArray[np.float64]
    ) -> NDArray[np.float64]: ...
    def extremes(
        self, stations: list[tuple[float, float]], times: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def root_mean_squares(
        self, stations: list[tuple[float, float]], times: NDArray[np.float64]
    ) -> NDArray[np.float64]: ...

@final
class Course:
    def __new__(cls, modes: Modes, profiles: list[Profile], damping_input: bool) -> Course: ...
    def sweep(
        self, speeds: NDArray[np.float64], stations: list[tuple[float, float]]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def worst(
        self,
        quantity: str,
        gear: int,
        point: tuple[float, float],
        speeds: tuple[float, float],
        tolerance: float,
        max_runs: int,
    ) -> tuple[float, float, float, int]: ...

@final
class Spectrum:
    @staticmethod
    def power_law(
        coefficient: float, waviness: float, reference: float, band: tuple[float, float]
    ) -> Spectrum: ...
    @staticmethod
    def table(n: NDArray[np.float64], psd: NDArray[np.float64]) -> Spectrum: ...
    def band(self) -> tuple[float, float]: ...
    def variance(self) -> float: ...
    def density(self, n: NDArray[np.float64]) -> NDArray[np.float64]: ...

@final
class Generator:
    def __new__(
        cls, spectrum: Spectrum, length: float, spacing: float, y: NDArray[np.float64], seed: int
    ) -> Generator: ...
    def stations(self) -> int: ...
    def elevations(self, first_run: int, out: NDArray[np.float64]) -> None: ...
