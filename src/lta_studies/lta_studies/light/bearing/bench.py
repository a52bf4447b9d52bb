# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Simulate light blocks of a vehicle at rest and estimate the bearing to the lamp."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
import math
from typing import Final, final, NamedTuple

from lta_config.topics import load_topic_table
from lta_control.motion import wrap_angle
from lta_flight.flight_spec import build_vehicle_scenario_stack, FlightSpec, load_spec
from lta_model.light.view import LightView
from lta_model.sensors.photodiode import PhotodiodeArray
from lta_report.palette import GOOD, LAMP, TRUTH
from lta_vlc.demodulation import demodulate_beacon, Peaks, plan_bins
from lta_vlc.diodes import build_diode_array
from lta_vlc.lamp import LampFinder
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
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


Pose = tuple[float, ...]  # position and quaternion x y z w


class BearingReading(NamedTuple):
    """Results of both estimators for one light block; NaN where there is no estimate."""

    snr: float  # SNR of the best diode
    # Errors of the bearing [rad]
    paper: float
    ours: float
    deviation: float  # standard deviation of the bearing, as estimated by the fit [rad]
    # Readings of the diodes, and the true direction of the lamp [rad, body]
    peaks: Peaks
    azimuth: float
    elevation: float


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
        if truth is not None:
            self._vehicle = build_vehicle_scenario_stack(truth)[0]
        # The compiled fit is the one that flies, and fast enough for thousands of poses.
        self._finder = LampFinder(self._believed)
        # Columns 0 to 2 are the positions of the diodes; bearings refer to their centre. [m, body]
        self._middle = self._vehicle.diodes.planes[:, :3].mean(axis=0)
        self._lamp = np.array(self.scenario.goal_lamp.position.vector)

    @property
    def diodes(self) -> PhotodiodeArray:
        """Return the simulated diodes, with equal gains."""
        return self._vehicle.diodes

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
        paper, ours, _ = self._finder.find_lamp(peaks, threshold, prior)
        nan = math.nan
        return BearingReading(
            float(peaks.snr.max()),
            nan if paper is None else wrap_angle(paper.angle - azimuth),
            nan if ours is None else wrap_angle(ours.azimuth - azimuth),
            nan if ours is None else math.sqrt(ours.azimuth_variance),
            peaks,
            azimuth,
            elevation,
        )

    def true_direction(self, pose: Pose) -> tuple[float, float]:
        """Return azimuth and elevation of the lamp from the middle of the diodes [rad, body]."""
        turn = Rotation.from_quat(pose[3:])
        x, y, z = turn.inv().apply(self._lamp - np.array(pose[:3])) - self._middle
        return math.atan2(y, x), math.atan2(z, math.hypot(x, y))


Array = NDArray[np.float64]
DIRECTION_COUNT: Final = 16
STUDY_DISTANCE: Final = 3.0  # m
# Off the lamp's axis, where reflections turn the mean most. On the axis of a symmetric room they
# are symmetric, too.
STUDY_OFF_AXIS: Final = math.radians(45.0)
STUDY_HEIGHT: Final = 0.5  # of the hull centre, that of the paper's flights [m]
READINGS_PER_DIRECTION: Final = 50
RING_COUNTS: Final = (4, 8, 16)


@final
@dataclass(frozen=True, slots=True)
class RingStudy:
    """Results of one ring in one place."""

    place: str  # name in `BEARING_PLACES`
    count: int  # number of diodes
    # Median error in each direction [rad]
    paper: tuple[float, ...]
    ours: tuple[float, ...]
    snr: float  # median SNR of the best diode


def error_quantile(errors: Array, percent: float) -> float:
    """Return a percentile of the absolute errors; NaN if there are none."""
    finite = np.abs(errors[np.isfinite(errors)])
    return float(np.percentile(finite, percent)) if finite.size else math.nan


def list_directions() -> list[float]:
    """Return the true directions of the lamp, seen from the ring [rad]."""
    return [math.tau * k / DIRECTION_COUNT for k in range(DIRECTION_COUNT)]


def study_ring(
    bench: BearingBench,
    place: str,
    count: int,
    readings: int,
    seed: int,
    aside: float = STUDY_OFF_AXIS,
) -> RingStudy:
    """Study one ring in all directions, `aside` of the lamp's axis [rad]."""
    # The same draws indoors and outdoors: only the place differs.
    chance = np.random.default_rng([seed, count])
    diodes = bench.sample_diode_gains(chance)
    paper, ours, snrs = [], [], []
    for direction in list_directions():
        pose = pose_for_lamp_direction(bench, direction, aside)
        blocks = [bench.estimate_block_bearing(pose, diodes, chance) for _ in range(readings)]
        paper.append(error_quantile(np.array([each.paper for each in blocks]), 50.0))
        ours.append(error_quantile(np.array([each.ours for each in blocks]), 50.0))
        snrs.append(float(np.median([each.snr for each in blocks])))
    return RingStudy(place, count, tuple(paper), tuple(ours), float(np.median(snrs)))


def pose_for_lamp_direction(
    bench: BearingBench, direction: float, aside: float = STUDY_OFF_AXIS
) -> Pose:
    """Return the level pose, `aside` of the axis, that has the lamp in a direction [rad]."""
    x, y, _ = bench.scenario.goal_lamp.position.vector
    ahead_x, ahead_y, _ = bench.scenario.goal_lamp.facing.vector
    facing = math.atan2(ahead_y, ahead_x) + aside
    # Half the heading: from the drone, the lamp is at facing + pi in the map.
    half = 0.5 * (facing + math.pi - direction)
    # The ring is below the hull centre, so a level ring has the same horizontal position.
    return (
        x + STUDY_DISTANCE * math.cos(facing), y + STUDY_DISTANCE * math.sin(facing), STUDY_HEIGHT,
        0.0, 0.0, math.sin(half), math.cos(half),
    )  # fmt: skip


def count_accurate_directions(errors: Sequence[float], limit: float) -> int:
    """Return the number of directions with a median error below a limit."""
    return sum(error < limit for error in errors)


RING_COLOURS: Final = dict(zip(RING_COUNTS, (LAMP, TRUTH, GOOD), strict=True))
RING_METHOD: Final = (
    'The hull is level at 0.5 m and turns through 16 directions. The diode gains of the vehicle '
    'are drawn once. Errors are medians over the readings; each reading is one block of ADC '
    'samples with its own noise.'
)


def describe_method(aside: float) -> str:
    """Describe the set-up, with the drone `aside` of the lamp's axis [rad]."""
    where = f'{math.degrees(aside):g} degrees off its axis' if aside else 'on its axis'
    return f'The lamp is {STUDY_DISTANCE:g} m away and the drone is {where}. {RING_METHOD}'


def median_error(errors: Sequence[float]) -> float:
    """Return the median over the directions; NaN if one has no bearing."""
    return float(np.median(errors))
