"""What wind each platform can fly in, over each ground, as one table."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
import math
from typing import Any, final

from lta_config.errors import BadInput
from lta_config.files import known
from lta_flight.ingredients import gather, Ingredients
from lta_model import limits
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.json_value import finite
from lta_sim import wind_limits
from lta_studies.wind.trial import Flyable, flyable, Ground, SHARES

STRATEGY = 'bag'
FASTEST = 3.0  # m/s; the most that a mission may ask for
CLEARANCE = 0.05  # m, that a large vehicle flies above where it stands


@final
@dataclass(frozen=True, slots=True)
class Asked:
    """What to find out."""

    vehicles: tuple[str, ...]
    roughness: tuple[float, ...]  # m
    height: float  # of the hull centre [m]
    reference: float  # height of the reference wind [m]
    scenario: str
    seeds: int
    quick: bool
    fly: bool


@final
@dataclass(frozen=True, slots=True)
class Over:
    """Limits over one ground, as reference wind. [m/s]"""

    roughness: float
    share: float  # of the reference wind at the hull
    static: float
    flown: Flyable | None


@final
@dataclass(frozen=True, slots=True)
class Limits:
    """
    Limits of one platform, in m/s; infinite where its known drag sets none.

    Attributes
    ----------
    name : str
        The vehicle.
    height : float
        Of its hull centre in flight. [m]
    thrust, tumble, rise, static : float
        Airspeed that the rotors hold, at which it tumbles and at which it rises, and the least.
    flown : Flyable or None
        By flight in uniform wind.
    over : tuple of Over
        By ground.
    note : str
        Why something is missing.

    """

    name: str
    height: float
    thrust: float
    tumble: float
    rise: float
    static: float
    flown: Flyable | None
    over: tuple[Over, ...]
    note: str = ''


def ticks(asked: Asked) -> int:
    """Return how often `measured` calls its tick at most."""
    each = (len(SHARES) + 1) * (_steps(asked) + 1) * (1 + len(asked.roughness))
    return sum(each for name in asked.vehicles if asked.fly and _gains(name))


def _steps(asked: Asked) -> int:
    return 4 if asked.quick else 6


def _gains(vehicle: str) -> str | None:
    """Return the gains of a platform's control law; None where none is shipped."""
    return vehicle if vehicle in known('control') else None


def measured(asked: Asked, name: str, tick: Callable[[], None]) -> Limits:
    """
    Return the limits of one platform.

    Raises
    ------
    BadInput
        If a file is wrong.

    """
    density = load_scenario(asked.scenario).air.density
    vehicle = load_vehicle(name, density)
    height = max(asked.height, vehicle.standing_height + CLEARANCE)
    try:
        thrust = wind_limits.thrust_speed(vehicle)
    except BadInput as error:
        nothing = tuple(
            Over(z, _share(vehicle, height, asked, z), 0.0, None) for z in asked.roughness
        )
        return Limits(name, height, 0.0, 0.0, 0.0, 0.0, None, nothing, str(error))
    tumble = math.inf if vehicle.file.hull.shape == 'none' else limits.tumble_speed(vehicle)
    rise = wind_limits.rise_speed(vehicle)
    static = min(thrust, tumble, rise)
    note = '' if math.isfinite(thrust) else 'its known drag sets no limit below 60 m/s.'
    flight = _flight(asked, name, height) if asked.fly else None
    if asked.fly and flight is None:
        note = (note + ' No control law is shipped for it, so it was not flown.').strip()

    def flown(ground: Ground, share: float) -> Flyable | None:
        if flight is None:
            return None
        return flyable(
            flight, ground, 1.1 * min(thrust, FASTEST) / share, _airspeeds(asked, flight, thrust),
            range(1, asked.seeds + 1), _steps(asked), tick,
        )  # fmt: skip

    over = []
    for z in asked.roughness:
        share = _share(vehicle, height, asked, z)
        over.append(Over(z, share, static / share, flown(Ground(z, asked.reference), share)))
    even = flown(Ground(None), 1.0)
    return Limits(name, height, thrust, tumble, rise, static, even, tuple(over), note)


def _share(vehicle: Vehicle, height: float, asked: Asked, roughness: float) -> float:
    """Return the share of the reference wind at the hull; one sentence where there is none."""
    if not roughness < asked.reference:
        raise BadInput(
            f'The roughness is {roughness:g} m, not below the reference height of '
            f'{asked.reference:g} m; make it less.'
        )
    share = wind_limits.share_at_hull(vehicle, height, asked.reference, roughness)
    if share <= 0.0:
        raise BadInput(
            f'Over a roughness of {roughness:g} m the log law has no wind at {height:g} m, where '
            f'{vehicle.file.name} flies; make the roughness less or the height more.'
        )
    return share


def _flight(asked: Asked, name: str, height: float) -> Ingredients | None:
    gains = _gains(name)
    if gains is None:
        return None
    made_of = gather(name, asked.scenario, STRATEGY, gains)
    return made_of.with_values({'mission.altitude': height})


def _airspeeds(asked: Asked, flight: Ingredients, thrust: float) -> Sequence[float]:
    """Return what to tell the drone: its mission's airspeed, then shares of the fastest."""
    fast = [round(min(share * thrust, FASTEST), 2) for share in SHARES]
    return [flight.held('mission.speed'), *(fast[1:3] if asked.quick else fast)]


def to_json(found: Sequence[Limits], asked: Asked) -> dict[str, Any]:
    """Return what --json prints; a limit that does not exist is null."""
    return {
        'scenario': asked.scenario,
        'height': asked.height,
        'reference_height': asked.reference,
        'seeds': asked.seeds,
        'vehicles': [finite(asdict(each)) for each in found],
        'units': {
            'height': 'm', 'reference_height': 'm', 'roughness': 'm', 'share': '1',
            'thrust': 'm/s', 'tumble': 'm/s', 'rise': 'm/s', 'static': 'm/s', 'wind': 'm/s',
            'airspeed': 'm/s', 'fine': 'm/s',
        },
    }  # fmt: skip
