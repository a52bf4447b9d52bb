"""A frame of markers on the vehicle: states through it."""

from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.sensing import marker_frame, transform_to_map
import numpy as np
from scipy.spatial.transform import Rotation

Known = tuple[NominalVehicle, list[FreeParameter]]
ARM, TURN = np.array([0.05, -0.02, 0.1]), (0.3, -0.2, 0.1)  # m; yaw, pitch, roll in rad


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
