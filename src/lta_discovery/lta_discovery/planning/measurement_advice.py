"""Suggest a measurement where no flight separates two effects."""

from typing import Final, NamedTuple

from lta_discovery.planning.equivalence_classes import is_equivalent, Kind


class MeasurementAdvice(NamedTuple):
    """Effects that flights confuse, and the measurement that separates them."""

    effects: frozenset[str]
    what: str


MEASURE: Final = (
    MeasurementAdvice(
        frozenset({'net_lift', 'payload', 'ballast', 'gas_purity'}),
        'each acts as a constant force; weigh the vehicle on a scale, without and with gas',
    ),
    MeasurementAdvice(
        frozenset({'tracker_delay', 'clock_offset', 'command_delay'}),
        'each is a delay; tap the vehicle and compare when its IMU and the tracker record it',
    ),
    MeasurementAdvice(
        frozenset({'added_mass', 'cg_height', 'thrust_scale', 'added_inertia', 'motor_lag'}),
        'they scale the response alike; measure the thrust on a scale, or fly a known payload',
    ),
    MeasurementAdvice(
        frozenset({'rotor_misalignment', 'rotor_fault', 'cg_offset', 'tracker_misalignment'}),
        'check the rotors, level the tracker, and measure one of these effects on its own',
    ),
    MeasurementAdvice(
        frozenset({'linear_drag', 'quadratic_drag', 'cross_flow'}),
        'tow the vehicle at two known speeds, or let it glide to rest with its motors off',
    ),
)
OTHERWISE: Final = 'measure one of these effects on its own'
RICHER: Final[dict[Kind, tuple[Kind, str]]] = {
    'pose': ('imu', 'record the IMU as well'),
    'imu': ('all', 'record range, pressure and voltage as well'),
    'wrench': ('pose', 'record the motor duties as well'),
    'hover': ('all', 'fly manoeuvres, not only a hover'),
}


def suggest_measurement(name: str, others: tuple[str, ...], kind: Kind) -> str:
    """
    Return how to separate an effect from others that no flight of a kind can separate.

    `name`, `others`: of parameters: 'net_lift.force'.
    """
    # Prefer more sensors or a richer flight, if they separate the effects
    richer = RICHER.get(kind)
    if richer is not None and not any(is_equivalent(name, one, richer[0]) for one in others):
        return richer[1]
    effects = {one.partition('.')[0] for one in (name, *others)}
    matches = (advice.what for advice in MEASURE if effects <= advice.effects)
    return next(matches, OTHERWISE)
