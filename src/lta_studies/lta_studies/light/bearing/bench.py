"""Simulate light blocks of a vehicle at rest and estimate the bearing to the lamp."""

from dataclasses import dataclass
import math
from typing import final

from lta_config.topics import load_topic_table
from lta_control.cascade import wrap_angle
from lta_flight.flight_spec import build_vehicle_scenario_stack, FlightSpec
from lta_model.light.view import LightView
from lta_model.sensors.photodiode import PhotodiodeArray
from lta_studies.light.bearing.poses import Pose
from lta_vlc.bearing import estimate_bearing
from lta_vlc.demodulation import demodulate_beacon, Peaks, plan_bins
from lta_vlc.diodes import build_diode_array
from lta_vlc.direction import DirectionFinder, RAYLEIGH_SHARE
import numpy as np
from numpy.random import Generator
from scipy.spatial.transform import Rotation


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
