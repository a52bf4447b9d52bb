# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compute the wind limits of each platform: in uniform wind, and over each ground."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
import math
from typing import Any, final

from lta_config.errors import BadInput
from lta_config.files import find_file, list_shipped_names, load_yaml, validate_content
from lta_config.parameter_override import draw_content, list_ranges
from lta_config.schema.vehicle_file import VehicleFile
from lta_model import limits
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.json_value import replace_nonfinite
from lta_report.report import Report
from lta_report.request import argument, Names, option, ReportRequest, StudyRun
from lta_sim import wind_limits
import numpy as np
from rich.progress import track

GROUND_ROUGHNESS = (
    0.03,
    0.1,
    0.3,
)  # m: grass, crops, bushes and low houses (unverified, from memory)
FLOOR_CLEARANCE = 0.05  # m between a large vehicle in flight and its position on the floor
LIMIT_DRAWS = 100  # of a vehicle with ranges


@final
class WindRequest(ReportRequest, command='wind'):
    """
    Report each platform's wind limit: uniform wind, and reference wind over rough ground.

    The limit is the lowest of the airspeed that the rotors can hold at constant height and
    heading, and the airspeeds above which the hull tumbles or rises nose-up regardless of its
    rotors. Numbers of the vehicle file that have a range give the limit an interval.

    Wind over rough ground is given at the reference height, as a weather service measures it; the
    log law yields the wind at the height of the hull. The log law is not accurate close to the
    roughness length, so compare several.

    Whether a strategy finds its lamp in such a wind, flights tell: "lta sweep
    light_uniform_winds".

    Exit status 0: done. 2: bad input.

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

    def run(self, run: StudyRun) -> Report:
        """Return the report of all platforms."""
        from lta_studies.wind.report import build_report

        names = self.vehicles or tuple(list_shipped_names('vehicles'))
        grounds = tuple(sorted(set(self.roughness)))
        request = self.replace(vehicles=names, roughness=grounds)
        # Load all before the first is computed
        vehicles = {name: load_vehicle(name) for name in names}
        for vehicle in vehicles.values():
            _list_hull_wind_shares(request, vehicle)  # raises for ground without any wind
        platforms = track(vehicles.items(), 'wind', console=run.console, transient=True)
        return build_report([measure_limits(request, *each) for each in platforms], request)


@final
@dataclass(frozen=True, slots=True)
class GroundWindLimit:
    """The limit over one ground, as wind at the reference height [m/s]."""

    roughness: float
    share: float  # of the reference wind at the hull
    static: float


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
    over: tuple[GroundWindLimit, ...]  # limit over each ground
    note: str = ''  # why a limit is missing
    # 5 % and 95 % of the lowest of the three with the numbers of the vehicle file drawn from their
    # ranges; None if it has no ranges
    interval: tuple[float, float] | None = None


def measure_limits(request: WindRequest, name: str, vehicle: Vehicle) -> PlatformWindLimits:
    """Compute the limits of one platform; raise `BadInput` for ground without any wind."""
    height = _flight_height(request, vehicle)
    shares = _list_hull_wind_shares(request, vehicle)
    thrust = tumble = rise = static = 0.0
    note, interval = '', None
    try:
        thrust = wind_limits.thrust_speed(vehicle)
    # No thrusts hold height and heading, so there are no limits; report why.
    except BadInput as error:
        note = str(error)
    else:
        # Without a hull there is no Munk moment that could tumble the vehicle.
        hull = vehicle.file.hull.shape != 'none'
        tumble = limits.tumble_speed(vehicle) if hull else math.inf
        rise = wind_limits.rise_speed(vehicle)
        static, interval = min(thrust, tumble, rise), draw_static_limit(name)
        if not math.isfinite(thrust):
            note = (
                'With the drag in its file it could fly faster than 60 m/s, the end of the search.'
            )
    over = tuple(
        # Division by the share converts wind at the hull to wind at the reference height.
        GroundWindLimit(z, share, static / share)
        for z, share in zip(request.roughness, shares, strict=True)
    )
    return PlatformWindLimits(name, height, thrust, tumble, rise, static, over, note, interval)


def draw_static_limit(name: str) -> tuple[float, float] | None:
    """Return 5 % and 95 % of the static limit over draws [m/s]; None without ranges."""
    content = load_yaml(find_file('vehicle', name))
    if not list_ranges(content):
        return None
    speeds = []
    for seed in range(1, LIMIT_DRAWS + 1):
        variant = draw_content(content, seed, 'vehicle')
        file = validate_content(VehicleFile, variant, f'a draw of {name}')
        speeds.append(wind_limits.static_wind_limit(Vehicle(file)))
    low, high = map(float, np.quantile(speeds, [0.05, 0.95]))
    return low, high


def _list_hull_wind_shares(request: WindRequest, vehicle: Vehicle) -> list[float]:
    """Return the ratio of the wind at the hull to the reference wind over each ground."""
    height = _flight_height(request, vehicle)
    return [_hull_wind_share(vehicle, height, request, z) for z in request.roughness]


def _flight_height(request: WindRequest, vehicle: Vehicle) -> float:
    """Return the height of the hull centre in flight; a large hull flies higher [m]."""
    return max(request.height, vehicle.hull_height_on_floor + FLOOR_CLEARANCE)


def _hull_wind_share(
    vehicle: Vehicle, height: float, request: WindRequest, roughness: float
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


def to_json(results: Sequence[PlatformWindLimits], request: WindRequest) -> dict[str, Any]:
    """Return the JSON output; a limit that does not exist is null."""
    return {
        'height': request.height,
        'reference_height': request.reference,
        'vehicles': [replace_nonfinite(asdict(each)) for each in results],
        'units': {
            'height': 'm', 'reference_height': 'm', 'roughness': 'm', 'share': '1',
            'thrust': 'm/s', 'tumble': 'm/s', 'rise': 'm/s', 'static': 'm/s',
        },
    }  # fmt: skip
