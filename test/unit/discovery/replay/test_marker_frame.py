"""A frame of markers on the vehicle: states through it and back, and slopes by differences."""

from dataclasses import replace

from lta_discovery.forecast.horizon_errors import compute_horizon_errors
from lta_discovery.model.calibration_parameters import list_marker_parameters
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
from lta_discovery.replay.sensing import marker_frame, transform_to_map
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

Known = tuple[NominalVehicle, list[FreeParameter]]
ARM, TURN = np.array([0.05, -0.02, 0.1]), (0.3, -0.2, 0.1)  # m; yaw, pitch, roll in rad
NEAR = (0.4, 1.0, 2.0)  # s; later the wrong markers leave too much over


def marked(nominal: NominalVehicle, share: float = 1.0) -> NominalVehicle:
    """Return a vehicle whose markers sit askew."""
    for name, value in zip(('x', 'y', 'z', 'yaw', 'pitch', 'roll'), [*ARM, *TURN], strict=True):
        nominal = nominal.with_value('marker_offset', name, share * float(value))
    return nominal


def test_states_of_markers_become_those_of_the_body(gtmab: Known) -> None:
    """Against rigid-body kinematics with SciPy's rotations."""
    acting = marked(gtmab[0]).build_replay_rows().acting
    frame = marker_frame(acting)
    assert frame is not None
    np.testing.assert_allclose(frame[0], ARM)
    body, own = Rotation.from_euler('ZYX', (0.7, 0.2, -0.1)), Rotation.from_euler('ZYX', TURN)
    place, velocity, rates = np.array([[1.0, 2.0, 3.0], [0.3, -0.1, 0.2], [0.1, -0.2, 0.4]])
    there = np.concatenate([
        place + body.apply(ARM),
        (body * own).as_quat(),
        own.apply(velocity + np.cross(rates, ARM), inverse=True),
        own.apply(rates, inverse=True),
    ])  # fmt: skip
    found = transform_to_map(there[None], acting)[0]
    np.testing.assert_allclose(found[:3], place, atol=1e-12)
    np.testing.assert_allclose(np.abs(found[3:7] @ body.as_quat()), 1.0, atol=1e-12)
    np.testing.assert_allclose(found[7:10], velocity, atol=1e-12)
    np.testing.assert_allclose(found[10:], rates, atol=1e-12)


@pytest.mark.parametrize('name', ['marker_offset.z', 'marker_offset.pitch', 'marker_offset.yaw'])
def test_columns_are_what_small_turns_do(gtmab: Known, clean: FlightLinearizer, name: str) -> None:
    # The flight has no markers askew: small ones leave little over
    nominal, known = marked(gtmab[0], 0.05), list_marker_parameters()
    flight = FlightLinearizer(clean.replay, [*gtmab[1], *known], clean.places)
    point = unchanged_vehicle_point(nominal, flight.knobs, flight.replay.cut)
    k = [knob.name for knob in flight.knobs].index(name)
    found = compute_horizon_errors(flight, point, [k], NEAR)
    step = 1e-4
    there = replace(point, nominal=flight.knobs[k].apply_to(nominal, step))
    slope = -(compute_horizon_errors(flight, there, horizons=NEAR).errors - found.errors) / step
    told = np.isfinite(found.errors)
    # Attitude errors turn with what is left over, as in the test of other columns
    np.testing.assert_allclose(
        found.columns[told, 0], slope[told], atol=0.07 * np.nanmax(np.abs(slope))
    )
