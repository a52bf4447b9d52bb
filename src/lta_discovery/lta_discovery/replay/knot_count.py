"""
Choose the number of knots of the latent wrench from the shortest natural period.

Missing effects follow the motion of the vehicle. If knots are further apart than a quarter of a
period, the latent wrench cannot follow, and the error appears as another effect, such as a heave
force or an oscillation. The number follows from the modes of the model, linearized along the
flight, and from the oscillations of the measured attitude.
"""

from collections.abc import Iterator, Sequence
import math
from typing import Final

from lta_discovery.flights.measured_flight import MeasuredFlight, PERIOD
from lta_discovery.flights.windows import KNOTS, LENGTH
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_logarithm,
    quaternion_product,
)
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearization_inputs import prepare_linearization
from lta_discovery.replay.linearized_flight import AXES, unchanged_vehicle_point
from lta_discovery.replay.sensing import transform_to_map
import numpy as np
from numpy.typing import NDArray
from scipy.signal import welch

Array = NDArray[np.float64]

PART: Final = 6.0  # knots per period
MOST: Final = 37  # knots of a piece: a period of 1 s
DAMPED: Final = 0.7  # damping ratio above which a mode does not count as oscillating
SLOWEST: Final = 0.2  # Hz; lowest frequency of oscillations in the attitude
FASTEST: Final = 2.0  # Hz; highest frequency
AVERAGED: Final = 256  # points of the grid in a spectrum, 10 s
CLEAR: Final = 10.0  # medians of the spectrum; smallest peak of an oscillation


def count_needed_knots(flights: Sequence[FlightLinearizer], nominal: NominalVehicle) -> int:
    """Return the number of knots that the pieces of some flights of a vehicle need."""
    periods = [vehicle_period(flight, nominal) for flight in flights]
    periods += [
        period for flight in flights for period in find_swing_periods(flight.replay.flight)
    ]
    count = math.ceil(PART * LENGTH / min(periods) - 1e-9) + 1
    return min(max(count, KNOTS), MOST)


def vehicle_period(flight: FlightLinearizer, nominal: NominalVehicle) -> float:
    """Return the shortest modal period along a flight; infinite if no mode oscillates. [s]"""
    about = prepare_linearization(
        flight.replay,
        flight.knobs,
        unchanged_vehicle_point(nominal, flight.knobs, flight.replay.cut),
        np.zeros(len(flight.knobs), dtype=np.bool_),
    )
    states = np.ascontiguousarray(
        transform_to_map(flight.replay.cut.start, about.rows.acting)[:, None]
    )
    none = np.zeros((*states.shape[:2], AXES))
    slopes = flight.replay.state_jacobians(about.turns, states, none)[:, 0]
    if not np.isfinite(slopes).all():
        return math.inf  # a diverging model has no period
    modes = np.linalg.eigvals(slopes)
    swinging = (modes.imag > 0.0) & (-modes.real < DAMPED * np.abs(modes))
    # Initial states are noisy: use the median over pieces.
    fastest = float(np.median(np.max(np.where(swinging, modes.imag, 0.0), axis=1)))
    return 2.0 * math.pi / fastest if fastest > 0.0 else math.inf


def find_swing_periods(flight: MeasuredFlight) -> Iterator[float]:
    """Yield the period of the strongest oscillation about each body axis that has one. [s]"""
    turned = quaternion_logarithm(
        quaternion_product(quaternion_conjugate(flight.quaternion[:-1]), flight.quaternion[1:])
    )
    for rate in turned.T / PERIOD:
        # Gaps in the pose; filled with 0 below
        finite = np.isfinite(rate)
        if finite.sum() < AVERAGED:
            continue
        hertz, power = welch(np.where(finite, rate, 0.0), 1.0 / PERIOD, nperseg=AVERAGED)
        band = np.flatnonzero((hertz >= SLOWEST) & (hertz <= FASTEST))
        top = band[np.argmax(power[band])]
        # A maximum at the edge of the band is a slope, not a peak
        peak = power[top] >= max(power[top - 1], power[top + 1])
        if peak and power[top] > CLEAR * float(np.median(power)):
            yield float(1.0 / hertz[top])
