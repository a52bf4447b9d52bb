"""
Compile the kernels that several test files share, before the workers start.

Otherwise each worker would compile them by itself. `lta simulate` compiles those of a flight; this
script adds those of discovery's replay and of the challenge, each by its first call.
"""

from pathlib import Path
import sys

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / 'test' / 'unit'))

from discovery.hidden_flight import flown, nominal, prepared  # noqa: E402
from lta_challenge.case import CaseGenerator  # noqa: E402
from lta_challenge.make import load_challenge_vehicle  # noqa: E402
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point  # noqa: E402
from lta_discovery.state_filter.forecast_sums import list_starts  # noqa: E402
from lta_discovery.state_filter.kalman import filter_flight  # noqa: E402
from lta_discovery.state_filter.linear_flight import FlightSystem  # noqa: E402
from lta_discovery.state_filter.noise_model import NoiseModel  # noqa: E402
from lta_model.vehicle import load_vehicle  # noqa: E402
import numpy as np  # noqa: E402


def main() -> None:
    """Linearise and filter a short flight, and draw a case of the challenge."""
    vehicle, knobs = nominal()
    flight = prepared(flown({}, seed=1, length=8.0), knobs)
    flight.linearize(unchanged_vehicle_point(vehicle, knobs, flight.replay.cut))
    system = FlightSystem(load_vehicle('gtmab'), flight.replay.flight, knobs)
    linear = system.linearize(vehicle, np.zeros(len(knobs)))
    noise = NoiseModel.guess(vehicle, system.flight)
    filter_flight(linear, noise, list_starts(linear.runs, 1.0), (0.4,))
    CaseGenerator(load_challenge_vehicle(), 0, 0, 'base', 'clean', (20.0, 24.0)).generate_case()


if __name__ == '__main__':
    main()
