"""
Which loss of helium ends it: for the rotors by their thrust, for the gains by flying.

Gains hold as long as a drone that lost that much lift, and does not know it, takes off, climbs by
0.4 m and comes down again with its altitude within 0.3 m at the end of each. Losses are tried in
even steps up to what the rotors can carry, then the bracket is halved. Days follow from what the
film lets through (`lta_vehicle.figures.helium_leak`).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import final

from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_control.cascade import CascadeGains
from lta_model.hover import select_lifting_rotors
from lta_model.vehicle import Vehicle
from lta_studies.tune.metrics import compute_response_metrics
from lta_studies.tune.step_response import fly_steps, STEPS, TuningCase, TuningScene
from lta_vehicle.figures.helium_leak import daily_lift_loss

TRIED = 6
HALVINGS = 4
CLIMB_AND_SINK = STEPS[:2]


@final
@dataclass(frozen=True, slots=True)
class HeliumLimit:
    """
    The largest losses of lift, against the trim of the vehicle file.

    Attributes
    ----------
    grams : float or None
        Up to which the gains hold, flown; None if they do not hold without any loss. [g]
    fails : float
        The least loss that was flown and lost its altitude; infinite if none did. [g]
    rotors : float
        That full thrust carries. [g]
    demand : float
        That the largest vertical force which the gains may ask for carries. [g]
    days : tuple of float
        Until `grams` are gone, at the largest and the least permeation; 0 if they are None. [d]

    """

    grams: float | None
    fails: float
    rotors: float
    demand: float
    days: tuple[float, float]


def rotor_loss_limit(vehicle: Vehicle) -> float:
    """Return the loss of lift that the rotors carry at full thrust. [kg]"""
    own, per_newton = select_lifting_rotors(vehicle.rotors, vehicle.file.aero.coupling)
    if not own or per_newton <= 0.0:
        raise BadInput(f'{vehicle.file.name} has no rotor that lifts; it cannot hover.')
    full = min(rotor.full_thrust for rotor in own) * per_newton
    return full / STANDARD_GRAVITY - vehicle.heaviness


def find_helium_limit(
    vehicle: str,
    gains: CascadeGains,
    seeds: Sequence[int] = (1,),
    tell: Callable[[float, bool], None] = lambda loss, held: None,
) -> HeliumLimit:
    """
    Return up to which loss of helium gains hold.

    Parameters
    ----------
    vehicle : str
        Name or file.
    gains : CascadeGains
        Of its controller.
    seeds : sequence of int
        All must hold.
    tell : callable
        Hears each loss that was tried [kg], and whether the gains held.

    Raises
    ------
    BadInput
        If the vehicle cannot hover.

    """
    scene = TuningScene(vehicle)
    known = scene.nominal_vehicle
    most = rotor_loss_limit(known)

    def holds(loss: float) -> bool:
        cases = (TuningCase(loss, seed) for seed in seeds)
        held = not any(
            compute_response_metrics(
                fly_steps(scene, gains, case, CLIMB_AND_SINK), CLIMB_AND_SINK
            ).lost
            for case in cases
        )
        tell(loss, held)
        return held

    low, high = bracket_limit(holds, most)
    least, largest = daily_lift_loss(known.file.hull, known.air_density)
    lasts = 0.0 if low is None else low
    return HeliumLimit(
        grams=None if low is None else 1e3 * low,
        fails=1e3 * high,
        rotors=1e3 * most,
        demand=1e3 * (gains.climb.limit / STANDARD_GRAVITY - known.heaviness),
        days=(lasts / largest, lasts / least) if largest > 0.0 else (0.0, 0.0),
    )


def bracket_limit(holds: Callable[[float], bool], most: float) -> tuple[float | None, float]:
    """Return the last value that holds and the first that does not, as near as was tried."""
    low: float | None = None
    high = float('inf')
    for step in range(TRIED + 1):
        at = most * step / TRIED
        if not holds(at):
            high = at
            break
        low = at
    if low is None or high == float('inf'):
        return low, high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low, high
