"""Errors of forecasts by direction: along the nose, sideways, up, and of the length of the way."""

import math

from lta_discovery.calibration.coarse_fit import LONG
from lta_discovery.calibration.forecast_score import (
    FAR,
    score_axes,
    score_forecasts,
    split_by_direction,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.transfer.overlapping_pieces import cut_overlapping_pieces
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

Known = tuple[NominalVehicle, list[FreeParameter]]
TURN = math.radians(25.0)


@pytest.fixture(scope='module')
def pieces(gtmab: Known, clean: FlightLinearizer) -> FlightLinearizer:
    """Pieces of 3 s of a flight without a hidden effect."""
    out = cut_overlapping_pieces(clean, gtmab[1], 2.5, LONG[-1])
    assert out is not None
    return out


def test_an_error_along_the_nose_is_that_alone(gtmab: Known, pieces: FlightLinearizer) -> None:
    nose = Rotation.from_quat(pieces.replay.cut.start[:, 3:7]).as_matrix()[:, :, 0]
    nose[:, 2] = 0.0
    nose /= np.linalg.norm(nose, axis=1, keepdims=True)
    split = split_by_direction(pieces, gtmab[0], 0.1 * nose + [0.0, 0.0, 0.03])
    np.testing.assert_allclose(split[:, :3], np.tile([0.1, 0.0, 0.03], (len(nose), 1)), atol=1e-9)


def test_markers_that_are_turned_are_no_nose(gtmab: Known, pieces: FlightLinearizer) -> None:
    """Markers turned to the left by 25 degrees on the vehicle: the nose is to their right."""
    turned = gtmab[0].with_value('marker_offset', 'yaw', TURN)
    error = np.tile([0.1, 0.02, 0.0], (len(pieces.replay.first), 1))
    plain, split = (split_by_direction(pieces, one, error) for one in (gtmab[0], turned))
    # By the axes of a frame that is turned by -25 degrees
    along = plain[:, 0] * math.cos(TURN) - plain[:, 1] * math.sin(TURN)
    np.testing.assert_allclose(split[:, 0], along, atol=2e-3)


def test_a_turn_of_the_way_does_not_change_its_length(
    gtmab: Known, pieces: FlightLinearizer
) -> None:
    """A forecast that goes as far in another direction, and one that goes 5 cm too far."""
    measured = pieces.replay.flight.position[pieces.index[:, pieces.replay.cut.length - 1]]
    moved = measured - pieces.replay.cut.start[:, :3]
    other = Rotation.from_euler('z', TURN).apply(moved)
    split = split_by_direction(pieces, gtmab[0], moved - other)
    np.testing.assert_allclose(split[:, 3], 0.0, atol=1e-9)
    assert np.abs(split[:, :2]).max() > 0.1
    flat = moved * [1.0, 1.0, 0.0]
    farther = 0.05 * flat / np.linalg.norm(flat, axis=1, keepdims=True)
    split = split_by_direction(pieces, gtmab[0], -farther)
    np.testing.assert_allclose(split[:, 3], -0.05, atol=1e-9)


def test_the_directions_add_up_to_the_error_of_the_position(
    gtmab: Known, clean: FlightLinearizer
) -> None:
    """A file with 20 mN too little lift sinks; at 8 s by more than at 3 s."""
    heavy = gtmab[0].with_value('net_lift', 'force', -0.02)
    near, far = score_axes(heavy, [clean], np.zeros(len(gtmab[1])), [np.zeros(len(gtmab[1]))])
    assert (near.horizon, far.horizon) == (LONG[-1], FAR)
    assert 0.02 < near.before[2] < far.before[2]
    assert near.before[2] > 5.0 * max(near.before[0], near.before[1])
    assert near.before == near.after


def test_a_flight_has_its_own_trend_of_the_lift(gtmab: Known, clean: FlightLinearizer) -> None:
    """A file whose lift grows by 1 mN/s, and a flight whose own trend makes up for it."""
    knob = next(k for k, one in enumerate(gtmab[1]) if one.name == 'helium_leak.rate')
    rising = gtmab[0].with_value('helium_leak', 'rate', -1e-3)
    none, own = np.zeros(len(gtmab[1])), np.zeros(len(gtmab[1]))
    own[knob] = 1e-3
    (kept,) = score_forecasts(gtmab[0], [clean], none, [none])[-1:]
    (mended,) = score_forecasts(rising, [clean], none, [own])[-1:]
    assert mended.before[0] > 3.0 * kept.before[0]
    assert mended.after == pytest.approx(kept.after, rel=1e-6)
