"""
Tell whether angles in degrees were read as radians, or angles in radians as degrees.

Velocity, rates and the lean of an accelerating vehicle agree with one of the readings. Rates may
be in the wrong unit, too, and late by a filter.
"""

from typing import Final

from lta_config.constants import STANDARD_GRAVITY
from lta_data.data_quality.motion import PoseSeries, VectorSeries
from lta_data.data_quality.motion_scales import (
    ALIKE,
    covers_place,
    DEGREES,
    fit_rates,
    fit_tilt,
    fit_velocity,
    is_inverted,
    is_near,
    largest_angle,
    magnify_angles,
    measure_turn,
    OFFSETS,
    quaternions_of,
    shrink_angles,
    TILT,
    tumbling_pace,
    TURN,
    upright_share,
)
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
RIGID: Final = 0.01  # range of angles that is too small for any flight [rad]
STIFF: Final = 0.03  # the same, of a vehicle that accelerates too much for its lean [rad]
LEANLESS: Final = 5.0  # acceleration by lean that is too much, by gravity
TRAVEL: Final = 0.5  # extent of a flight whose angles cannot stay that small [m]
TUMBLING: Final = 5.0  # usual rates of a vehicle that is not upright [rad/s]
TURNING: Final = 2.0  # least usual rates at which angles can be 57.3 times too large [rad/s]
TINY: Final = 0.06  # half a turn, 57.3 times too small [rad]
FOLLOWED: Final = 0.7  # cosine of a velocity that agrees with larger angles, if late
MORE: Final = 0.02  # change of a cosine that tells one reading from another
NUMERIC: Final = 1e-5  # what a velocity without noise disagrees by, as it is interpolated
UNEXPLAINED: Final = 0.6  # of what a velocity disagrees by, left with larger angles


def find_wrong_angle_unit(pose: PoseSeries, rates: list[VectorSeries]) -> tuple[str, float] | None:
    """
    Return why the attitude is in the wrong unit, and the factor that corrects its angles.

    None if it is not. `rates`: all that were recorded, of the pose and of inertial sensors.
    """
    attitude = pose.attitude
    if attitude is None or len(attitude.time) < 100:
        return None
    small = magnify_angles(attitude.values)
    if reason := _explain_small_angles(pose, small):
        return _describe_small_angles(reason), DEGREES
    if _agrees_as_recorded(pose, rates):
        return None
    pace = tumbling_pace(attitude)
    if pace > TUMBLING and upright_share(attitude.values) < 0.9:
        why = f'read as radians, the vehicle would tumble at {pace:.3g} rad/s'
        return _describe_large_angles(why), 1.0 / DEGREES
    if largest_angle(attitude.values) < TINY and _explains(pose, rates, small, 1.0 / DEGREES):
        why = f'with larger ones {_name_agreement(pose, rates)} agrees'
        return _describe_small_angles(why), DEGREES
    calm = upright_share(attitude.values) > 0.5 or is_inverted(attitude.values)
    if pace < TURNING and calm:
        return None
    angles = shrink_angles(attitude.values)
    for yaw in np.arange(OFFSETS) * (TURN / DEGREES) if pose.velocity is not None else (0.0,):
        if _explains(pose, rates, quaternions_of(angles, float(yaw)), DEGREES):
            why = f'with smaller angles {_name_agreement(pose, rates)} agrees'
            return _describe_large_angles(why), 1.0 / DEGREES
    return None


def _describe_small_angles(why: str) -> str:
    return f'The angles are 57.3 times too small (radians read as degrees): {why}.'


def _describe_large_angles(why: str) -> str:
    return (
        f'The unit looks like deg: {why}; the angles are 57.3 times too large (degrees read as '
        'radians).'
    )


def _explain_small_angles(pose: PoseSeries, small: Array) -> str:
    """
    Return why the angles are too small, whatever the rates say; empty if they need not be.

    `small`: the attitude with angles 57.3 times as large. Rates in the wrong unit agree with it.
    """
    assert pose.attitude is not None
    before, after = fit_velocity(pose).cosine, fit_velocity(pose, small).cosine
    left = 1.0 - before
    if after > FOLLOWED and left > NUMERIC and 1.0 - after < UNEXPLAINED * left:
        assert pose.velocity is not None
        return f"with larger ones '{pose.velocity.name}' agrees"
    turn = measure_turn(pose.attitude)
    if pose.position is None or not (pose.tracked and covers_place(pose) and turn < STIFF):
        return ''
    lean = fit_tilt(pose)
    leans = abs(lean.cosine) > TILT and lean.factor > LEANLESS * STANDARD_GRAVITY
    extent = float(np.max(np.ptp(pose.position.values, axis=0)))
    # An attitude that does not change at all is another finding
    if extent < TRAVEL or not RIGID / DEGREES < turn < (STIFF if leans else RIGID):
        return ''
    if after < before - MORE:
        return ''
    return (
        f'yaw, pitch and roll stay within {DEGREES * turn:.2g} degrees, while the vehicle covers '
        f'{extent:.2g} m'
    )


def _agrees_as_recorded(pose: PoseSeries, rates: list[VectorSeries]) -> bool:
    """Return whether all that can be compared agrees, so that no other reading is needed."""
    assert pose.attitude is not None
    speed, lean = fit_velocity(pose), fit_tilt(pose)
    turns = [fit_rates(pose, one) for one in rates]
    return (
        upright_share(pose.attitude.values) > 0.9
        and (pose.velocity is None or speed.cosine > ALIKE)
        and all(fit.cosine > ALIKE and is_near(fit.factor, 1.0) for fit in turns)
        and (lean.cosine < TILT or abs(np.log(lean.factor / STANDARD_GRAVITY)) < 1.0)
    )


def _name_agreement(pose: PoseSeries, rates: list[VectorSeries]) -> str:
    names = [vector.name for vector in rates[:1]]
    names += [pose.velocity.name] if pose.velocity is not None else []
    return f"'{names[0]}'" if names else 'an upright vehicle'


def _explains(pose: PoseSeries, rates: list[VectorSeries], turn: Array, excess: float) -> bool:
    """
    Return whether another reading of the attitude is right and the recorded one is not.

    `excess` is by how much the recorded angles are too large.
    """
    assert pose.attitude is not None
    if upright_share(turn) < 0.9:
        return False
    votes = []
    before, after = fit_velocity(pose), fit_velocity(pose, turn)
    if max(before.cosine, after.cosine) > ALIKE and abs(after.cosine - before.cosine) > MORE:
        votes.append(after.cosine > before.cosine)
    lean = fit_tilt(pose), fit_tilt(pose, turn)
    if max(lean[0].cosine, lean[1].cosine) > TILT:
        sizes = [abs(np.log(one.factor / STANDARD_GRAVITY)) if one.cosine > TILT else 9.0
                 for one in lean]  # fmt: skip
        votes.append(sizes[1] < 1.0 < sizes[0])
    recorded = [fit_rates(pose, one) for one in rates]
    reread = [fit_rates(pose, one, turn) for one in rates]
    matched = [fit for fit in reread if fit.cosine > ALIKE]
    if upright_share(pose.attitude.values) < 0.5 and excess > 1.0:
        return bool(matched) or not rates or after.cosine > ALIKE
    # Rates that agree with the recorded angles are wrong too, or right
    for old, new in zip(recorded, reread, strict=True):
        if old.cosine > ALIKE and is_near(old.factor, 1.0) and not votes:
            return False
        if new.cosine > ALIKE and is_near(new.factor, 1.0) and not is_near(old.factor, 1.0):
            votes.append(True) if len(rates) > 1 or not votes else None
    return bool(votes) and all(votes)
