"""Damping from swings alone, against swings of an independent simulator."""

from dataclasses import replace
import itertools

from lta_challenge.other.flight import FlightSimulator
from lta_challenge.other.truth import build_vehicle_truth, VehicleTruth
from lta_discovery.fit.evidence import build_shared_prior, per_flight_variance, wrench_floor
from lta_discovery.fit.joint_fit import JointFit, JointFitter
from lta_discovery.flights.measured_flight import FlightStreams, Stream
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
from lta_model.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.spatial.transform import Rotation

from ..hidden_flight import prepared  # noqa: TID252 - `test` is Python's own

Array = NDArray[np.float64]
Known = tuple[NominalVehicle, list[FreeParameter]]
LINEAR, SQUARE = 'rotational_drag.pitch', 'rotational_drag.pitch_2'


class Silent:
    """A pilot whose rotors stand still."""

    def initial_duties(self) -> list[float]:
        """Return no duties."""
        return [0.0] * 4

    def compute_duties(self, time: float, state: list[float]) -> list[float]:
        """Return no duties."""
        return [0.0] * 4


@pytest.fixture(scope='module')
def truth() -> VehicleTruth:
    """A weightless GT-MAB that swings slower, and is damped otherwise than in its file."""
    file = build_vehicle_truth(load_vehicle('gtmab'))
    return replace(
        file,
        lift=9.81 * (file.mass - file.displaced),
        inertia=(file.inertia[0], 1.06 * file.inertia[1], file.inertia[2]),
        turn_linear=(file.turn_linear[0], 1.7 * file.turn_linear[1], file.turn_linear[2]),
        turn_square=(file.turn_square[0], 0.5 * file.turn_square[1], file.turn_square[2]),
    )


def swing(truth: VehicleTruth, angle: float, seconds: float) -> tuple[Array, Array]:
    """Return times and poses of a release from an angle: position, quaternion x y z w."""
    half = 0.5 * angle
    begin = [0.0, 0.0, 2.0, 0.0, 0.0, 0.0, np.cos(half), 0.0, np.sin(half), 0.0, 0.0, 0.0, 0.0]
    path = FlightSimulator(truth, Silent()).simulate_flight(begin, seconds)
    kept = slice(2, None, 2)
    states = path.states[kept]
    return path.time[kept], np.column_stack([states[:, :3], states[:, 7:10], states[:, 6]])


def pitch_of(pose: Array) -> Array:
    """Return the pitch of poses. [rad]"""
    return 2.0 * np.arctan2(pose[:, 4], pose[:, 6])


def seen_by_tracker(truth: VehicleTruth, angle: float, seed: int) -> FlightStreams:
    """Return the log of a release, with the noise of a tracker."""
    time, pose = swing(truth, angle, 20.0)
    draw = np.random.default_rng(seed)
    pose[:, :3] += 1e-3 * draw.standard_normal((len(time), 3))
    wobble = Rotation.from_rotvec(2.5e-3 * draw.standard_normal((len(time), 3)))
    pose[:, 3:] = (Rotation.from_quat(pose[:, 3:]) * wobble).as_quat()
    return FlightStreams(Stream(time, pose), Stream(time[:1], np.zeros((1, 4))))


@pytest.fixture(scope='module')
def fit(gtmab: Known, truth: VehicleTruth) -> JointFit:
    """Three releases, fitted with both dampings free."""
    nominal, knobs = gtmab
    flights = [
        prepared(seen_by_tracker(truth, angle, seed), knobs)
        for seed, angle in enumerate((0.4, 0.35, 0.25))
    ]
    prior = build_shared_prior(knobs, (LINEAR, SQUARE))
    fitter = JointFitter(nominal, flights, per_flight_variance(knobs), wrench_floor(nominal))
    points = [unchanged_vehicle_point(nominal, knobs, one.replay.cut) for one in flights]
    begin = fitter.linearize_flights(points[0].values, points, prior)
    return fitter.fit(prior, begin, wrench_floor(nominal), narrow=True)


def estimated(fit: JointFit, truth: VehicleTruth, gtmab: Known) -> VehicleTruth:
    """Return the vehicle of the file with the estimated numbers, for the other simulator."""
    _, knobs = gtmab
    at = {knob.name: float(v) for knob, v in zip(knobs, fit.fitted.mean, strict=False)}
    file = build_vehicle_truth(load_vehicle('gtmab'))
    linear, square = file.turn_linear[1] + at[LINEAR], file.turn_square[1] + at[SQUARE]
    return replace(
        file,
        lift=truth.lift,
        mass=file.mass * np.exp(at['vehicle.mass']),
        displaced=file.displaced + file.mass * (np.exp(at['vehicle.mass']) - 1.0),
        cg=(0.0, 0.0, file.cg[2] + at['cg_height.z']),
        inertia=(file.inertia[0], file.inertia[1] * np.exp(at['vehicle.pitch']), file.inertia[2]),
        added_mass=tuple(
            value + at[f'added_mass.{axis}']
            for value, axis in zip(file.added_mass, ('surge', 'sway', 'heave'), strict=True)
        ),
        added_inertia=(
            file.added_inertia[0], file.added_inertia[1] + at['added_inertia.pitch'], 0.0,
        ),
        drag=tuple(
            value + at[f'quadratic_drag.{axis}']
            for value, axis in zip(file.drag, ('surge', 'sway', 'heave'), strict=True)
        ),
        turn_linear=(file.turn_linear[0], linear, file.turn_linear[2]),
        turn_square=(file.turn_square[0], square, file.turn_square[2]),
    )  # fmt: skip


def period_and_decay(truth: VehicleTruth, angle: float) -> tuple[float, float]:
    """Return the period of a release [s], and its logarithmic decrement."""
    time, pose = swing(truth, angle, 8.0)
    pitch = pitch_of(pose)
    up = np.flatnonzero((pitch[:-1] < 0.0) & (pitch[1:] >= 0.0))
    begun = time[up] - pitch[up] * (time[1] - time[0]) / (pitch[up + 1] - pitch[up])
    tops = [pitch[a:b].max() for a, b in itertools.pairwise(up)]
    return float(np.diff(begun).mean()), float(np.log(tops[0] / tops[-1])) / (len(tops) - 1)


@pytest.mark.parametrize('angle', [0.05, 0.1, 0.2, 0.4])
def test_swings_alone_separate_linear_from_quadratic_damping(
    fit: JointFit, truth: VehicleTruth, gtmab: Known, angle: float
) -> None:
    period, decay = period_and_decay(truth, angle)
    found = period_and_decay(estimated(fit, truth, gtmab), angle)
    assert found[0] == pytest.approx(period, rel=0.02)
    assert found[1] == pytest.approx(decay, rel=0.1)
