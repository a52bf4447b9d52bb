# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compile the kernels that several test files share, before the workers start.

Otherwise each worker would compile them by itself. `lta simulate` compiles those of a flight; this
script adds those of discovery, each by its first call.
"""

from pathlib import Path
import sys

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / 'test' / 'unit'))

from discovery.hidden_flight import flown, nominal  # noqa: E402
from lta_discovery.flights.measured_flight import resample_flight  # noqa: E402
from lta_discovery.state_filter.forecast_noise import list_starts  # noqa: E402
from lta_discovery.state_filter.kalman import filter_flight  # noqa: E402
from lta_discovery.state_filter.linear_flight import FlightSystem  # noqa: E402
from lta_discovery.state_filter.noise_model import NoiseModel  # noqa: E402
from lta_model.vehicle import load_vehicle  # noqa: E402
import numpy as np  # noqa: E402


def main() -> None:
    """Linearize and filter a short flight."""
    vehicle, knobs = nominal()
    flight = resample_flight(flown({}, seed=1, length=8.0))
    system = FlightSystem(load_vehicle('gtmab'), flight, knobs)
    linear = system.linearize(vehicle, np.zeros(len(knobs)))
    noise = NoiseModel.guess(vehicle, system.flight)
    filter_flight(linear, noise, list_starts(linear.runs, 1.0), (0.4,))


if __name__ == '__main__':
    main()
