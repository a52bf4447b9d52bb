"""What is linear about a smoothed motion: what no flight can show leaves no trace."""

from lta_discovery.flights.measured_flight import resample_flight
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_discovery.state_filter.kalman import filter_flight
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_discovery.state_filter.noise_model import NoiseModel
from lta_discovery.state_filter.smoothing import smooth_flight
from lta_model.vehicle import load_vehicle
import numpy as np

from ..hidden_flight import flown  # noqa: TID252 - `test` is Python's own

SMOOTHED = 3  # times; each leaves the square of what the one before left out


def test_a_turn_of_the_tracker_about_the_vertical_cannot_be_seen() -> None:
    """
    Nothing in a still hall knows north, so all headings of the tracker's frame fit as well.

    About noisy poses the same column seems to be known to some hundredths of a radian.
    """
    vehicle, flight = load_vehicle('gtmab'), resample_flight(flown({}, 1, 24.0))
    nominal = NominalVehicle.from_vehicle(vehicle)
    parameters = list_free_parameters(nominal)
    yaw = [one.name for one in parameters].index('tracker_misalignment.yaw')
    system, noise = FlightSystem(vehicle, flight, parameters), NoiseModel.guess(nominal, flight)
    none, information = np.zeros(len(parameters)), list[float]()
    for _ in range(SMOOTHED + 1):
        linear = system.linearize(nominal, none)
        information.append(float(filter_flight(linear, noise).products[yaw, yaw]))
        smooth = smooth_flight(linear, noise, none)
        system = system.with_motion(smooth.motion, smooth.wrench, nominal)
    assert information[0] > 10.0
    assert information[-1] < 1e-3
