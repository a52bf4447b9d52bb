"""Simulate light blocks of a vehicle at rest and estimate the bearing to the lamp."""

from collections.abc import Mapping
from dataclasses import dataclass, field
import math
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_control.cascade import wrap_angle
from lta_flight.flight_spec import build_vehicle_scenario_stack, FlightSpec, load_spec
from lta_model.light.view import LightView
from lta_model.scenario import Scenario
from lta_model.sensors.photodiode import PhotodiodeArray
from lta_vlc.bearing import estimate_bearing
from lta_vlc.demodulation import demodulate_beacon, Peaks, plan_bins
from lta_vlc.diodes import build_diode_array
from lta_vlc.direction import DirectionFinder, RAYLEIGH_SHARE
import numpy as np
from numpy.random import Generator
from scipy.spatial.transform import Rotation

DIODES_PATH: Final = 'vehicle.sensors.diodes'
# In full daylight people mount a smaller resistor; GT-MAB's own saturates at 2 klx
FOR_SUN: Final = {
    f'{DIODES_PATH}.feedback': {
        'value': 10, 'unit': 'kohm', 'source': 'assumed: full scale near 20 klx, for daylight'
    }
}  # fmt: skip


class TrueDiodes(NamedTuple):
    """The simulated diodes where they differ from the vehicle file, which the drone assumes."""

    response: float | None = None  # exponent of the cosine
    gain_spread: float | None = None  # relative standard deviation of the gains


@final
@dataclass(frozen=True, slots=True)
class BearingScenario:
    """A named scenario file of the bearing studies, and what is mounted for it."""

    name: str
    scenario: str
    about: str
    mounted: Mapping[str, object] = field(default_factory=dict)


BEARING_PLACES: Final[dict[str, BearingScenario]] = {
    'indoor': BearingScenario('indoor', 'lamp_room', 'a room with reflecting surfaces'),
    'outdoor': BearingScenario(
        'outdoor', 'sunny_field', 'a field in full daylight, 80 klx on the ground', FOR_SUN
    ),
}


def build_flight_spec(
    place: BearingScenario, vehicle: str, count: int, diodes: TrueDiodes | None = None
) -> FlightSpec:
    """Return the spec of a vehicle with an even ring at a place; the file's diodes by default."""
    values: dict[str, object] = {f'{DIODES_PATH}.count': count, **place.mounted}
    changes = {} if diodes is None else diodes._asdict()
    for name, value in changes.items():
        if value is not None:
            values[f'{DIODES_PATH}.{name}'] = {'value': value, 'unit': '1', 'source': 'option'}
    return load_spec(vehicle, place.scenario, 'bag', '').with_values(values)


HULL_HEIGHTS: Final = 0.5, 1.5  # range of the hull centre's height, uniform [m]
TILT_DEVIATION: Final = math.radians(2.0)  # standard deviation of pitch and roll [rad]
LARGEST_OFF_AXIS: Final = math.radians(
    60.0
)  # largest angle to the lamp's axis, seen from above [rad]
WALL_DISTANCE: Final = 0.6  # minimum distance of the hull centre to a wall [m]
NEAREST: Final = 1.5  # minimum distance to the lamp; nearer, the diodes saturate [m]
FIELD_HALF_WIDTH: Final = 12.0  # maximum |x| and |y| of places in an open field [m]
POSE_TRIES: Final = 10_000

Pose = tuple[float, ...]  # position and quaternion x y z w


def draw_pose(
    scenario: Scenario,
    distance: float | None,
    chance: Generator,
    off_axis: float = LARGEST_OFF_AXIS,
) -> Pose:
    """
    Draw a random pose within the lamp's beam.

    `scenario`: the scene. `distance`: horizontal distance to the lamp; None for any place in the
    room [m]. `off_axis`: largest angle to the lamp's axis, seen from above [rad]. Raise `BadInput`
    if no place at that distance is in the room.
    """
    height = chance.uniform(*HULL_HEIGHTS)
    # Rejection sampling: draw places until one is usable.
    for _ in range(POSE_TRIES):
        x, y = draw_place(scenario, distance, chance, off_axis)
        if is_within_lamp_beam(scenario, x, y, off_axis):
            pitch, roll = TILT_DEVIATION * chance.standard_normal(2)
            # Upper-case axes are intrinsic: yaw, then pitch, then roll.
            turn = Rotation.from_euler('ZYX', [chance.uniform(-math.pi, math.pi), pitch, roll])
            return (x, y, height, *turn.as_quat().tolist())
    raise BadInput(
        f'The scenario {scenario.name} has no usable place at {distance:g} m from its lamp, '
        "inside the room and within the lamp's beam; choose a shorter --range."
    )


def draw_place(
    scenario: Scenario,
    distance: float | None,
    chance: Generator,
    off_axis: float = LARGEST_OFF_AXIS,
) -> tuple[float, float]:
    """Draw a horizontal position at a distance from the lamp, or anywhere. [m]"""
    lamp_x, lamp_y, _ = scenario.goal_lamp.position.vector
    length, width, _ = scenario.room.size.vector
    if distance is None:
        # A field is far larger than the range of the lamp, so places are limited to its middle.
        reach = [min(0.5 * side - WALL_DISTANCE, FIELD_HALF_WIDTH) for side in (length, width)]
        x, y = (chance.uniform(-each, each) for each in reach)
        return x, y
    ahead_x, ahead_y, _ = scenario.goal_lamp.facing.vector
    angle = math.atan2(ahead_y, ahead_x) + chance.uniform(-off_axis, off_axis)
    return lamp_x + distance * math.cos(angle), lamp_y + distance * math.sin(angle)


def is_within_lamp_beam(
    scenario: Scenario, x: float, y: float, off_axis: float = LARGEST_OFF_AXIS
) -> bool:
    """Return whether a place [m] is in the room, within the beam and far enough away."""
    lamp_x, lamp_y, _ = scenario.goal_lamp.position.vector
    ahead = np.array(scenario.goal_lamp.facing.vector[:2])
    length, width, _ = scenario.room.size.vector
    way = np.array([x - lamp_x, y - lamp_y])
    away = math.hypot(*way)
    inside = abs(x) <= 0.5 * length - WALL_DISTANCE and abs(y) <= 0.5 * width - WALL_DISTANCE
    # Angle by dot product; 1e-9 admits places exactly on the edge of the beam.
    within = way @ ahead >= (math.cos(off_axis) - 1e-9) * away * math.hypot(*ahead)
    return inside and bool(within) and away >= NEAREST


@final
@dataclass(frozen=True, slots=True)
class BearingReading:
    """Results of both estimators for one light block; NaN where there is no estimate."""

    snr: float  # SNR of the best diode
    # Errors of the bearing [rad]
    paper: float
    ours: float
    deviation: float  # standard deviation of the bearing, as estimated by the fit [rad]
    elevation: float  # error of the elevation [rad]
    # Standard deviation of the elevation, as estimated by the fit [rad]
    elevation_deviation: float
    bound: float  # least standard deviation of an unbiased bearing (`bearing_bound`) [rad]


@final
class BearingBench:
    """
    A vehicle in a scene with both bearing estimators.

    The drone assumes the diodes of `spec`; the simulated ones are those of `truth`, by default the
    same.
    """

    def __init__(self, spec: FlightSpec, truth: FlightSpec | None = None) -> None:
        self._vehicle, self.scenario, self._policy = build_vehicle_scenario_stack(spec)
        table = load_topic_table()
        self._rate, self._samples = table.light.sample_rate.si, table.light.samples
        self._bins = plan_bins(self._policy.demodulation, self._rate, self._samples)
        self._believed = build_diode_array(self._vehicle.file.sensors.diodes)
        self._ring = self._believed.ring
        if truth is not None:
            self._vehicle = build_vehicle_scenario_stack(truth)[0]
        # The compiled fit is the one that flies, and fast enough for thousands of poses.
        self._finder = DirectionFinder(self._believed)
        # Columns 0 to 2 are the positions of the diodes; bearings refer to their centre. [m, body]
        self._middle = self._vehicle.diodes.planes[:, :3].mean(axis=0)
        self._lamp = np.array(self.scenario.goal_lamp.position.vector)

    def sample_diode_gains(self, chance: Generator) -> PhotodiodeArray:
        """Return the diodes of one vehicle with random gains."""
        return self._vehicle.diodes.draw_gains(chance)

    def _simulate_peaks(self, pose: Pose, diodes: PhotodiodeArray, chance: Generator) -> Peaks:
        """Return the demodulated peaks of one light block, with a random phase of the lamp."""
        view = LightView(self.scenario.light_field, self._vehicle, diodes)
        view.record_pose(pose)
        # Random start within 1 s [ns], so that the phase of the lamp differs between blocks.
        start = int(chance.integers(1_000_000_000))
        block = view.sample_light_block(start, self._rate, self._samples, chance)
        return demodulate_beacon(block, self._bins)

    def estimate_block_bearing(
        self, pose: Pose, diodes: PhotodiodeArray, chance: Generator
    ) -> BearingReading:
        """
        Simulate one light block and estimate the bearing.

        Parameters
        ----------
        pose : tuple of float
            Pose of the hull at rest. [m, map]
        diodes : PhotodiodeArray
            The true diodes.
        chance : Generator
            Random generator of the noise and of the lamp's phase.

        """
        peaks = self._simulate_peaks(pose, diodes, chance)
        threshold, prior = self._policy.demodulation.threshold, self._policy.prior
        azimuth, elevation = self.true_direction(pose)
        # Both estimators get the same block.
        paper = estimate_bearing(peaks, self._ring, threshold)
        ours = self._finder.find(peaks, threshold, prior)
        nan = math.nan
        return BearingReading(
            float(peaks.snr.max()),
            nan if paper is None else wrap_angle(paper.angle - azimuth),
            nan if ours is None else wrap_angle(ours.azimuth - azimuth),
            nan if ours is None else math.sqrt(ours.azimuth_variance),
            nan if ours is None else ours.elevation - elevation,
            nan if ours is None else math.sqrt(ours.elevation_variance),
            bearing_bound(self._vehicle.diodes, peaks, azimuth, elevation),
        )

    def true_direction(self, pose: Pose) -> tuple[float, float]:
        """Return azimuth and elevation of the lamp from the middle of the diodes. [rad, body]"""
        turn = Rotation.from_quat(pose[3:])
        x, y, z = turn.inv().apply(self._lamp - np.array(pose[:3])) - self._middle
        return math.atan2(y, x), math.atan2(z, math.hypot(x, y))


def bearing_bound(
    diodes: PhotodiodeArray, peaks: Peaks, azimuth: float, elevation: float
) -> float:
    """
    Return the Cramer-Rao bound of the bearing's standard deviation. [rad]

    For an unbiased estimator that knows everything but the azimuth, the lamp's strength and an
    even pedestal: noise and unequal gains are all that disturbs it. Reflections and an unknown
    response come on top. Infinite if the readings do not depend on the azimuth.
    """
    axes = diodes.planes[:, 3:]
    level = math.cos(elevation)
    ray = np.array([level * math.cos(azimuth), level * math.sin(azimuth), math.sin(elevation)])
    left = np.array([-level * math.sin(azimuth), level * math.cos(azimuth), 0.0])
    cosine = np.maximum(axes @ ray, 0.0)
    facing = cosine**diodes.response
    slope = np.where(
        cosine > 0.0, diodes.response * facing / np.maximum(cosine, 1e-12) * (axes @ left), 0.0
    )
    # Strength and pedestal are linear; the readings give them
    linear = np.stack([facing, np.ones(len(axes))], axis=1)
    strength, pedestal = np.linalg.lstsq(linear, peaks.amplitude, rcond=None)[0]
    expected = strength * facing + pedestal
    variance = (RAYLEIGH_SHARE * peaks.noise) ** 2 + (diodes.gain_spread * expected) ** 2
    jacobian = np.column_stack([strength * slope, linear])
    information = jacobian.T @ (jacobian / variance[:, None])
    # Schur complement of the azimuth
    rest = (
        information[0, 0]
        - information[0, 1:]
        @ np.linalg.lstsq(information[1:, 1:], information[1:, 0], rcond=None)[0]
    )
    return float(1.0 / math.sqrt(rest)) if rest > 0.0 else math.inf
