"""
Forces of one gear, in one state.

Every law is smooth while the gear's state lasts; the `switches` of a state say when it ends and
which state follows. The integration thus never steps over a bend or a jump.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .aircraft import Gear
    from .springs import Array


@dataclass(frozen=True, slots=True)
class State:
    """Which branch each law of a gear is on."""

    #: Piece of the springs' law; 0 is off the runway or, for a strut alone, on its stop.
    piece: int
    #: Whether the tire touches.
    touching: bool = True
    #: 1 where the strut compresses, -1 where it extends, 0 where friction or the stop holds it.
    #: Without friction it is 1 in both directions.
    sense: int = 1


class Travel(NamedTuple):
    """How far the springs of a gear are compressed from static equilibrium, and how fast."""

    #: Of the strut; of strut and tire together where the wheel has no mass.
    compression: Any
    rate: Any
    #: Of the tire; not used where the wheel has no mass.
    deflection: Any = 0.0


class MasslessGear:
    """
    Strut and tire in series, a viscous damper across both: F = F_spring(s) + cṡ ≥ 0.

    Parameters
    ----------
    gear : Gear
        The gear.
    static : float
        Its static load [force].
    """

    def __init__(self, gear: Gear, static: float) -> None:
        self._law = gear._law(static)
        self._damping = gear.damping

    def start(self, travel: Travel) -> State:
        """State at rest."""
        return State(self._law.piece(travel.compression))

    def strut_load(self, state: State, travel: Travel) -> Any:
        """Load on the body."""
        if state.piece == 0 or not state.touching:
            return 0.0 * travel.compression
        return self._law.load(state.piece, travel.compression) + self._damping * travel.rate

    def load(self, state: State, travel: Travel) -> Any:
        """Load on the runway: the same."""
        return self.strut_load(state, travel)

    def stiffness(self, state: State, travel: Travel) -> Array:
        """Tangent stiffness of strut and tire in series, 0 off the runway."""
        piece = state.piece if state.touching else 0
        return self._law.stiffness(piece, self._law.load(piece, travel.compression))

    def switches(self, state: State, travel: Travel, _holding: Any) -> Iterator[tuple[Any, State]]:
        """Quantities that are positive while the state lasts, and the state that follows."""
        kinks, piece = self._law.kinks, state.piece
        if piece < len(kinks):
            yield kinks[piece] - travel.compression, replace(state, piece=piece + 1)
        if piece == 0:
            return
        yield travel.compression - kinks[piece - 1], State(piece - 1, state.touching or piece == 1)
        if self._damping:
            push = self._law.load(piece, travel.compression) + self._damping * travel.rate
            yield push if state.touching else -push, State(piece, not state.touching)

    def impulse(self, before: float, after: float) -> float:
        """
        Impulse of the damper where the elevation steps, from one compression to another.

        It is c times the added compression of the springs; a step down gives none, as the gear does
        not pull.
        """
        return self._damping * max(0.0, after - max(before, self._law.kinks[0]))


class SprungGear:
    """
    Wheel with mass between a tire and a strut.

    The strut carries F = F_gas(s) + cṡ + Cṡ|ṡ| + F_friction sgn ṡ (Milwitzky and Cook, NACA
    Report 1154) plus the holding force while friction or the stop keeps it from sliding; the
    tire carries kd ≥ 0.

    Parameters
    ----------
    gear : Gear
        The gear.
    static : float
        Static load of its strut [force].
    gravity : float
        Gravity [length/time²].
    """

    def __init__(self, gear: Gear, static: float, gravity: float) -> None:
        self._gear = gear
        self._strut = gear._law(static, tire=False)
        self._tire = gear._law(static + gear.unsprung_mass * gravity, strut=False)

    def squeeze(self, load: float) -> float:
        """Compression of the strut in equilibrium under a load."""
        return self._strut.compression(load)

    def start(self, travel: Travel) -> State:
        """State at rest."""
        piece = self._strut.piece(travel.compression)
        held = piece == 0 or self._gear.friction > 0.0
        return State(piece, self._tire.piece(travel.deflection) == 1, 0 if held else 1)

    def strut_load(self, state: State, travel: Travel) -> Any:
        """Load on the body, without the force that holds the strut."""
        gear, rate = self._gear, travel.rate
        load = self._strut.load(state.piece, travel.compression) + gear.damping * rate
        if gear.orifice is not None:
            load = load + gear.orifice.force(rate)
        return load + gear.friction * state.sense

    def load(self, state: State, travel: Travel) -> Any:
        """Load on the runway."""
        return self._tire.load(int(state.touching), travel.deflection)

    def stiffness(self, state: State, travel: Travel) -> Array:
        """Tangent stiffness of gas and tire in series, the tire's on the stop, 0 in the air."""
        tire: Array = self._tire.stiffness(int(state.touching), self.load(state, travel))
        if state.piece == 0 or not state.touching:
            return tire
        load = self._strut.load(state.piece, travel.compression)
        strut = self._strut.stiffness(state.piece, load)
        both: Array = tire * strut / (tire + strut)
        return both

    def switches(self, state: State, travel: Travel, holding: Any) -> Iterator[tuple[Any, State]]:
        """Quantities that are positive while the state lasts, and the state that follows."""
        above = travel.deflection - self._tire.kinks[0]
        yield above if state.touching else -above, replace(state, touching=not state.touching)
        friction, piece, kinks = self._gear.friction, state.piece, self._strut.kinks
        if state.sense == 0:
            yield friction - holding, State(max(piece, 1), state.touching, 1)
            if piece > 0:
                yield friction + holding, State(piece, state.touching, -1)
            return
        if friction:
            yield state.sense * travel.rate, replace(state, sense=0)
        if piece < len(kinks):
            yield kinks[piece] - travel.compression, replace(state, piece=piece + 1)
        sense = state.sense if piece > 1 else 0
        yield travel.compression - kinks[piece - 1], State(piece - 1, state.touching, sense)
