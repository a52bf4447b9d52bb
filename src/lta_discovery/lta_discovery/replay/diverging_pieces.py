"""Drop the pieces of a flight in which the simulation diverges."""

from dataclasses import replace
from typing import Final

from lta_config.errors import BadInput
from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
from lta_discovery.replay.replay import STEPS
import numpy as np

SOON: Final = 1.0  # s; a piece that diverges later can still be fitted from its beginning
FASTEST: Final = 100.0  # m/s or rad/s; a faster simulated vehicle has diverged


def drop_diverging_pieces(
    flight: FlightLinearizer, nominal: NominalVehicle
) -> tuple[FlightLinearizer, int]:
    """Return a flight without the pieces that diverge with a vehicle at once, and their number."""
    cut = flight.replay.cut
    point = unchanged_vehicle_point(nominal, flight.knobs, cut)
    with np.errstate(all='ignore'):
        try:
            states = flight.simulate_forecast(point)[:, : round(SOON / PERIOD) * STEPS]
        except BadInput:
            return flight, 0  # the search reports an impossible vehicle
    # Comparisons with NaN are false
    sound = (np.abs(states[..., 7:]) < FASTEST).all(axis=(1, 2))
    if sound.all():
        return flight, 0
    sound_cut = replace(
        cut, first=cut.first[sound], start=cut.start[sound], inside=cut.inside[sound]
    )
    return FlightLinearizer(
        flight.replay.with_pieces(sound_cut), flight.knobs, flight.places
    ), int(np.sum(~sound))
