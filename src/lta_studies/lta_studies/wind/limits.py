# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compute the static and flown wind limits of each platform over each ground."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
import math
from typing import Any, Final, final

from lta_config.errors import BadInput
from lta_config.files import find_file, list_shipped_names, load_yaml, validate_content
from lta_config.parameter_override import draw_content, list_ranges
from lta_config.schema.vehicle_file import VehicleFile
from lta_flight.flight_spec import FlightSpec, load_spec
from lta_model import limits
from lta_model.scenario import load_scenario, VERTICAL_TOLERANCE
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.json_value import replace_nonfinite
from lta_report.report import Report
from lta_report.request import argument, Names, option, StudyRequest, StudyRun
from lta_report.study import hash_inputs, Study
from lta_report.study_store import StoreFormat
from lta_report.workers import report_progress
from lta_sim import wind_limits
from lta_studies.wind.flyable_wind import find_flyable_wind, FlyableWind, GroundWind, SHARES
import numpy as np
from pydantic import TypeAdapter

WIND_STRATEGY = 'bag'
LARGEST_AIRSPEED = 3.0  # m/s; upper limit of the parameter mission.speed
GROUND_ROUGHNESS = (
    0.03,
    0.1,
    0.3,
)  # m: grass, crops, bushes and low houses (unverified, from memory)
FLOOR_CLEARANCE = 0.05  # m between a large vehicle in flight and its position on the floor
LIMIT_DRAWS = 100  # of a vehicle with ranges
HEIGHT_TOLERANCE = 0.5  # m; half a hull: how exactly the height is held, with room to spare


@final
class WindStudyRequest(
    StudyRequest, command='wind', quick='One seed, three airspeeds, coarse steps of the wind.'
):
    """
    Report each platform's wind limit: uniform wind, and reference wind over rough ground.

    Static limits: the airspeed that the rotors can hold at constant height and heading, and the
    airspeeds above which the hull tumbles or rises nose-up regardless of its rotors. Flown limit:
    the strongest headwind in which the drone still approaches the lamp with every seed, at the
    best of several commanded airspeeds. Only platforms with a control law are flown.

    Wind over rough ground is given at the reference height, as a weather service measures it; the
    log law yields the wind at the height of the hull. The log law is not accurate close to the
    roughness length, so compare several.

    Ctrl-C reports the platforms that are finished.

    Exit status 0: done. 2: bad input. 130: Ctrl-C.

    Example: lta wind gtmab skye --roughness 0.03 --roughness 0.3
    """

    vehicles: Names = argument(
        'Vehicle names or files; all shipped vehicles by default.', default=()
    )
    roughness: tuple[float, ...] = option(
        'Roughness length of the ground in metres; repeat to compare several.',
        default=GROUND_ROUGHNESS, low=1e-5, high=5.0,
    )  # fmt: skip
    height: float = option(
        'Height of the hull centre above ground in metres.', default=0.5, low=0.1, high=100.0
    )
    reference: float = option(
        'Height above rough ground, in metres, for which the wind limits are given.',
        default=10.0, low=0.5, high=300.0,
    )  # fmt: skip
    scenario: str = option(
        'Scenario to fly in. The study sets the mean wind; the turbulence is that of the '
        'scenario.',
        default='windy_field', complete='scenario',
    )  # fmt: skip
    seeds: int = option(
        'Number of flights at each wind speed; the drone can fly in this wind if all of them make '
        'headway.',
        default=3, low=1, high=1000,
    )  # fmt: skip
    fly: bool = option('Simulate flights; --no-fly computes only the static limits.', default=True)

    def run(self, run: StudyRun) -> Report:
        """Return the report of all platforms."""
        from lta_studies.wind.report import build_report

        request = self.replace(
            vehicles=self.vehicles or tuple(list_shipped_names('vehicles')),
            roughness=tuple(sorted(set(self.roughness))),
            seeds=1 if self.quick else self.seeds,
        )
        return build_report(find_limits(request, run), request)


@final
@dataclass(frozen=True, slots=True)
class GroundWindLimits:
    """Limits over one ground, as wind at the reference height [m/s]."""

    roughness: float
    share: float  # of the reference wind at the hull
    static: float
    flown: FlyableWind | None


@final
@dataclass(frozen=True, slots=True)
class PlatformWindLimits:
    """Wind limits of one platform in m/s; infinite where its known drag sets none."""

    name: str  # vehicle
    height: float  # height of the hull centre in flight [m]
    # Airspeed that the rotors can hold, airspeeds at which the vehicle tumbles and rises, and the
    # lowest of the three
    thrust: float
    tumble: float
    rise: float
    static: float
    flown: FlyableWind | None  # limit flown in uniform wind
    over: tuple[GroundWindLimits, ...]  # limits over each ground
    note: str = ''  # why a limit is missing
    # 5 % and 95 % of the lowest of the three with the numbers of the vehicle file drawn from their
    # ranges; None if it has no ranges
    interval: tuple[float, float] | None = None


def _bisection_steps(request: WindStudyRequest) -> int:
    return 4 if request.quick else 6


def _find_gains_name(vehicle: str) -> str | None:
    """Return the gains that a vehicle file names, those shipped under its name, or None."""
    control = load_vehicle(vehicle).file.control
    if control is not None and control.gains is not None:
        return control.gains
    return vehicle if vehicle in list_shipped_names('control') else None


LIMIT_STORE: Final = StoreFormat(
    'limits.jsonl',
    'wind',
    'study of wind limits',
    TypeAdapter(PlatformWindLimits),
)


def find_limits(request: WindStudyRequest, run: StudyRun) -> list[PlatformWindLimits]:
    """
    Return the limits of all platforms; after Ctrl-C those of the finished ones.

    Raise `BadInput` if a file is invalid, KeyboardInterrupt if
    none was finished.
    """
    scene = load_scenario(request.scenario)
    vehicles = [load_vehicle(name, scene.air.density) for name in request.vehicles]
    # Before the first flight: ground over which there is no wind
    for vehicle in vehicles:
        height = _flight_height(request, vehicle)
        for z in request.roughness:
            _hull_wind_share(vehicle, height, request, z)
    keys = {
        name: f'{name} {hash_inputs(vehicle.file.model_dump_json())}'
        for name, vehicle in zip(request.vehicles, vehicles, strict=True)
    }
    study = Study(partial(measure_limits, request), keys.__getitem__, LIMIT_STORE, 'platforms')
    # Which vehicles are compared does not change the limits of one
    identity = hash_inputs(request.identify('vehicles'), scene.model_dump_json())
    outcome = study.run(list(keys), run.folder, identity, run.options, run.console)
    return list(outcome.results.values()) if outcome.stopped else outcome.require_all()


def measure_limits(request: WindStudyRequest, name: str) -> PlatformWindLimits:
    """Compute the limits of one platform; raise `BadInput` for an invalid file."""
    density = load_scenario(request.scenario).air.density
    vehicle = load_vehicle(name, density)
    height = _flight_height(request, vehicle)
    try:
        thrust = wind_limits.thrust_speed(vehicle)
    # No thrusts hold height and heading, so there are no limits; report why.
    except BadInput as error:
        nothing = tuple(
            GroundWindLimits(z, _hull_wind_share(vehicle, height, request, z), 0.0, None)
            for z in request.roughness
        )
        return PlatformWindLimits(name, height, 0.0, 0.0, 0.0, 0.0, None, nothing, str(error))
    # Without a hull there is no Munk moment that could tumble the vehicle.
    tumble = math.inf if vehicle.file.hull.shape == 'none' else limits.tumble_speed(vehicle)
    rise = wind_limits.rise_speed(vehicle)
    static = min(thrust, tumble, rise)
    note = (
        ''
        if math.isfinite(thrust)
        else 'With the drag in its file it could fly faster than 60 m/s, the end of the search.'
    )
    flight = _build_flight_spec(request, name, height) if request.fly else None
    if request.fly and flight is None:
        words = ' Not flown, as its file names no gains (control.gains; lta tune finds some).'
        note = (note + words).strip()

    grounds = 1 + len(request.roughness)

    def find_wind_over_ground(place: int, ground: GroundWind, share: float) -> FlyableWind | None:
        if flight is None:
            return None
        # 10 % above the static limit, so that the bisection can end above it.
        return find_flyable_wind(
            flight, ground, 1.1 * min(thrust, LARGEST_AIRSPEED) / share,
            _list_airspeeds(request, flight, thrust), range(1, request.seeds + 1),
            _bisection_steps(request), lambda part: report_progress((place + part) / grounds),
        )  # fmt: skip

    over = []
    for place, z in enumerate(request.roughness):
        share = _hull_wind_share(vehicle, height, request, z)
        over.append(
            GroundWindLimits(
                # Division by the share converts wind at the hull to wind at the reference height.
                z,
                share,
                static / share,
                find_wind_over_ground(place, GroundWind(z, request.reference), share),
            )
        )
    # Uniform wind: the hull gets all of it.
    even = find_wind_over_ground(grounds - 1, GroundWind(None), 1.0)
    return PlatformWindLimits(
        name, height, thrust, tumble, rise, static, even, tuple(over), note,
        None if request.quick else draw_static_limit(name, density),
    )  # fmt: skip


def draw_static_limit(name: str, density: float) -> tuple[float, float] | None:
    """Return 5 % and 95 % of the static limit over draws [m/s]; None without ranges."""
    content = load_yaml(find_file('vehicle', name))
    if not list_ranges(content):
        return None
    speeds = []
    for seed in range(1, LIMIT_DRAWS + 1):
        variant = draw_content(content, seed, 'vehicle')
        file = validate_content(VehicleFile, variant, f'a draw of {name}')
        speeds.append(wind_limits.static_wind_limit(Vehicle(file, density)))
    low, high = map(float, np.quantile(speeds, [0.05, 0.95]))
    return low, high


def _flight_height(request: WindStudyRequest, vehicle: Vehicle) -> float:
    """Return the height of the hull centre in flight; a large hull flies higher [m]."""
    return max(request.height, vehicle.hull_height_on_floor + FLOOR_CLEARANCE)


def _hull_wind_share(
    vehicle: Vehicle, height: float, request: WindStudyRequest, roughness: float
) -> float:
    """Return the share of the reference wind at the hull; raise `BadInput` if it is zero."""
    if not roughness < request.reference:
        raise BadInput(
            f'The roughness length --roughness {roughness:g} m is not below the height of the '
            f'given wind, --reference {request.reference:g} m; choose a smaller --roughness.'
        )
    share = wind_limits.wind_share_at_hull(vehicle, height, request.reference, roughness)
    if share <= 0.0:
        raise BadInput(
            f'Over ground with a roughness length of {roughness:g} m, the logarithmic wind '
            f'profile has no wind at {height:g} m, where {vehicle.file.name} flies; choose a '
            'smaller --roughness or a larger --height.'
        )
    return share


def _build_flight_spec(request: WindStudyRequest, name: str, height: float) -> FlightSpec | None:
    gains = _find_gains_name(name)
    if gains is None:
        return None
    made_of = load_spec(name, request.scenario, WIND_STRATEGY, gains)
    lamp = load_scenario(request.scenario).target_lamps[0].position.vector[2]
    scene = made_of.contents['scenario']
    # The study flies at a given height, wherever the lamp stands
    tolerance = f'{max(VERTICAL_TOLERANCE.si, abs(height - lamp) + HEIGHT_TOLERANCE):.2f} m'
    goal = {**scene['goal'], 'vertical_tolerance': tolerance}
    made_of = replace(made_of, contents={**made_of.contents, 'scenario': {**scene, 'goal': goal}})
    return made_of.with_values({'mission.altitude': height})


def _list_airspeeds(
    request: WindStudyRequest, flight: FlightSpec, thrust: float
) -> Sequence[float]:
    """Return the airspeeds to try: that of the mission, then shares of the top speed."""
    # Rounded to cm/s, as the value appears on the page and in commands.
    fast = [round(min(share * thrust, LARGEST_AIRSPEED), 2) for share in SHARES]
    return [flight.read_value('mission.speed'), *(fast[1:3] if request.quick else fast)]


def to_json(results: Sequence[PlatformWindLimits], request: WindStudyRequest) -> dict[str, Any]:
    """Return the JSON output; a limit that does not exist is null."""
    return {
        'scenario': request.scenario,
        'height': request.height,
        'reference_height': request.reference,
        'seeds': request.seeds,
        'vehicles': [replace_nonfinite(asdict(each)) for each in results],
        'units': {
            'height': 'm', 'reference_height': 'm', 'roughness': 'm', 'share': '1',
            'thrust': 'm/s', 'tumble': 'm/s', 'rise': 'm/s', 'static': 'm/s', 'wind': 'm/s',
            'airspeed': 'm/s', 'fine': 'm/s',
        },
    }  # fmt: skip
