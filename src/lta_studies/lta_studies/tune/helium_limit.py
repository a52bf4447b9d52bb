# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Find the largest helium loss that the rotors and the gains tolerate.

The limit of the rotors follows from their thrust; that of the gains is found by flying. Gains
tolerate a loss if a drone that is unaware of it takes off, climbs by 0.4 m and descends again,
with the altitude within 0.3 m at the end of each step. Losses are tried in equal steps up to the
limit of the rotors, then by bisection. Days follow from the permeation of the film
(`lta_vehicle.figures.helium_leak`).

Good step responses are not enough: gains can turn the drone too slowly for its guidance, so that
it flies past its goal. Each test flight is therefore followed by one mission in the shipped scene,
flown by `lta_flight.closed_loop` with the light link.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import final

from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_control.laws.cascade import CascadeGains
from lta_model.propulsion import select_lifting_rotors
from lta_model.vehicle import Vehicle
from lta_studies.tune.compare import compute_response_metrics
from lta_studies.tune.step_response import fly_steps, SETPOINT_STEPS, TuningCase, TuningScene
from lta_vehicle.figures.helium_leak import daily_lift_loss

TRIED_LOSSES = 6  # equal steps from no loss to what the rotors carry
HALVINGS = 4  # bisections of the bracket
CLIMB_AND_SINK = SETPOINT_STEPS[:2]


@final
@dataclass(frozen=True, slots=True)
class HeliumLimit:
    """The largest losses of lift, relative to the trim of the vehicle file."""

    # Largest loss flown successfully; None if the gains fail even without a loss [g]
    grams: float | None
    fails: float  # smallest loss at which the altitude was lost; infinite if none [g]
    rotors: float  # loss that full thrust compensates [g]
    demand: float  # loss that the vertical force limit of the gains compensates [g]
    # Time to lose `grams` at the largest and the smallest permeation; 0 if None [d]
    days: tuple[float, float]


def rotor_lift_loss_limit(vehicle: Vehicle) -> float:
    """Return the loss of lift that full thrust compensates [kg]."""
    own, per_newton = select_lifting_rotors(vehicle.rotors, vehicle.file.aero.coupling)
    if not own or per_newton <= 0.0:
        raise BadInput(
            f'{vehicle.file.name} has no rotor that lifts, so it cannot hover; choose '
            'another vehicle.'
        )
    # The weakest rotor limits the rest: more of one alone would tilt the vehicle.
    full = min(rotor.full_thrust for rotor in own) * per_newton
    return full / STANDARD_GRAVITY - vehicle.heaviness


def find_tolerable_helium_loss(
    vehicle: str,
    gains: CascadeGains,
    seeds: Sequence[int] = (1,),
    tell: Callable[[float, bool], None] = lambda loss, held: None,
) -> HeliumLimit:
    """
    Find the largest helium loss that a set of gains tolerates.

    `vehicle`: name or file. `seeds`: random seeds; the gains must hold with all of them. `tell`:
    progress callback: loss that was tried [kg], whether the gains held. Raise `BadInput` if the
    vehicle cannot hover.
    """
    scene = TuningScene(vehicle)
    nominal = scene.nominal_vehicle
    most = rotor_lift_loss_limit(nominal)

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
    # The permeation of the film is known as a range, hence two durations.
    least, largest = daily_lift_loss(nominal.file.hull, nominal.air_density)
    lasts = 0.0 if low is None else low
    return HeliumLimit(
        grams=None if low is None else 1e3 * low,
        fails=1e3 * high,
        rotors=1e3 * most,
        # The force limit in kg of lift, less what the vehicle already weighs. [g]
        demand=1e3 * (gains.climb.limit / STANDARD_GRAVITY - nominal.heaviness),
        days=(lasts / largest, lasts / least) if largest > 0.0 else (0.0, 0.0),
    )


def bracket_limit(holds: Callable[[float], bool], most: float) -> tuple[float | None, float]:
    """Return the largest tried value that holds and the smallest that does not."""
    low: float | None = None
    high = float('inf')
    # Coarse steps first: the smallest failing loss counts, even if a larger one held again.
    for step in range(TRIED_LOSSES + 1):
        at = most * step / TRIED_LOSSES
        if not holds(at):
            high = at
            break
        low = at
    # Without a bracket there is nothing to bisect.
    if low is None or high == float('inf'):
        return low, high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low, high
