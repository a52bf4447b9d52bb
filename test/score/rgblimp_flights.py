"""RGBlimp's published flights, in pieces of 0.5 s to begin with and 5 s to predict."""

from collections.abc import Sequence
import os
from pathlib import Path
from typing import Final, final, NamedTuple

from lta_discovery.flights.measured_flight import (
    FlightStreams,
    MeasuredFlight,
    PERIOD,
    resample_flight,
    Stream,
)
from lta_discovery.flights.windows import Windows
from lta_discovery.forecast.horizon_errors import HORIZONS
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_exponential,
    quaternion_logarithm,
    quaternion_product,
    rotate_vectors,
)
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.replay import FlightReplay
from lta_discovery.replay.sensing import SensorPlaces
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray
import pandas as pd
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
BESIDE: Final = Path(__file__).resolve().parents[3] / 'shared' / 'data'
DATA: Final = Path(os.environ.get('LTA_DATA', BESIDE)) / 'rgblimp'
FLIGHTS: Final = 100
REPEATS: Final = 4
RATE: Final = 60.0  # Hz; the files have no time
LEAD: Final = 0.5  # s; of poses before a prediction
STRIDE: Final = 2.75  # s; between predictions that are scored
APART: Final = 5.5  # s; between those that teach
FLIP: Final = np.array([1.0, -1.0, -1.0])  # z down there, up here


@final
class Flight(NamedTuple):
    """A flight, what it was told, and its pieces to learn from and to be scored by."""

    measured: MeasuredFlight
    mass_place: float
    forces: tuple[float, float]
    taught: FlightLinearizer
    scored: FlightLinearizer


def streams(table: Array, full_thrust: float) -> FlightStreams:
    """Return the streams of a file; the same as `lta import` makes of it."""
    time = np.arange(len(table)) / RATE
    turn = Rotation.from_euler('ZYX', table[:, [5, 4, 3]]).as_matrix()
    quaternion = Rotation.from_matrix(FLIP[:, None] * turn * FLIP).as_quat()
    pose = Stream(time, np.hstack([table[:, :3] * FLIP, quaternion]))
    duty = Stream(time[:1], table[:1, 18:20] / full_thrust)
    return FlightStreams(pose, duty, mass=Stream(time[:1], table[:1, 12:15] * FLIP))


def state_before(flight: MeasuredFlight, index: int) -> Array:
    """
    Return the state at a point from a cubic through the poses of the half second before.

    Nothing of what comes later is used, as the files are: smoothed already, both ways.
    """
    some = slice(index - round(LEAD / PERIOD), index + 1)
    offset, middle = flight.time[some] - flight.time[index], flight.quaternion[index]
    turn = quaternion_logarithm(
        quaternion_product(quaternion_conjugate(middle), flight.quaternion[some])
    )
    powers = np.vander(offset / LEAD, 4, increasing=True)
    fit = np.linalg.lstsq(powers, np.hstack([flight.position[some], turn]), rcond=None)[0]
    here = quaternion_product(middle, quaternion_exponential(fit[0, 3:]))
    velocity = rotate_vectors(quaternion_conjugate(here), fit[1, :3] / LEAD)
    return np.concatenate([fit[0, :3], here, velocity, fit[1, 3:] / LEAD])


def pieces(flight: MeasuredFlight, apart: float) -> Windows:
    """Return pieces that begin so many seconds apart."""
    count, lead = round(HORIZONS[-1] / PERIOD), round(LEAD / PERIOD)
    last = len(flight.time) - 1 - count
    starts = np.arange(0.0, PERIOD * (last - lead) + 1e-9, apart)
    first = lead + np.rint(starts / PERIOD).astype(np.int64)
    states = np.array([state_before(flight, int(index)) for index in first])
    return Windows(first, count + 1, states, np.ones((len(first), count + 1), dtype=np.bool_))


def flights(vehicle: Vehicle, knobs: Sequence[FreeParameter], full_thrust: float) -> list[Flight]:
    out, places = [], SensorPlaces.from_vehicle(vehicle, 101325.0)
    for i in range(1, FLIGHTS + 1):
        table = pd.read_csv(DATA / f'data_{i}.csv.gz').to_numpy(dtype=np.float64)
        flight = resample_flight(streams(table, full_thrust))
        taught, scored = (
            FlightLinearizer(
                FlightReplay(flight, pieces(flight, apart), vehicle.pack_command(())),
                knobs,
                places,
            )
            for apart in (APART, STRIDE)
        )
        forces = float(table[0, 18]), float(table[0, 19])
        out.append(Flight(flight, float(table[0, 12]), forces, taught, scored))
    return out


def begun(flight: Flight) -> Array:
    """Return when each scored piece begins. [s]"""
    replay = flight.scored.replay
    started: Array = replay.flight.time[replay.cut.first]
    return started


def regimes(known: Sequence[Flight]) -> dict[str, list[int]]:
    """Return the flights by where the moving mass was, and by the forces of the propellers."""
    out: dict[str, list[int]] = {}
    for f, flight in enumerate(known):
        left, right = flight.forces
        for name in (
            f'moving mass at {flight.mass_place:.4f} m',
            f'propellers at {1e3 * left:.0f} and {1e3 * right:.0f} mN',
        ):
            out.setdefault(name, []).append(f)
    return out
