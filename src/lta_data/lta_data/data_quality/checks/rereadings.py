# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Detect a log that was read with the wrong unit of time, length or angle, or with z upside down.

Each is a reading of the whole topic, so that one cause has one finding: times 1000 times too
short make a vehicle fast, its turns quick and its clock late, but only the times are wrong. Of
angles in degrees and in radians, one agrees with velocity, rates and the lean of an accelerating
vehicle; rates may be in the wrong unit, too, and late by a filter.
"""

from collections.abc import Iterator
from typing import Final

from lta_config.constants import DEGREES_PER_RADIAN, STANDARD_GRAVITY
from lta_data.data_quality import limits
from lta_data.data_quality.motion import PoseMotion, PoseSeries, VectorSeries
from lta_data.data_quality.recording import CheckContext, QualityFinding, Severity
from lta_data.even_grid import hann_kernel, median_period, smooth_columns
from lta_data.interpretation.attitude_readings import (
    FULL_TURN_RADIANS,
    magnify_angles,
    measure_turn,
    OFFSETS,
    shrink_angles,
)
from lta_data.interpretation.kinematics import (
    differentiate,
    FILTER_DELAY,
    fit_scale,
    is_near,
    NO_FIT,
    ScaleFit,
)
from lta_data.interpretation.vertical import (
    fit_tilt,
    is_inverted,
    judge_heights,
    judge_tilt,
    TILT_COSINE,
    upright_share,
)
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
SAME_MOTION_COSINE: Final = 0.85  # cosine of two vectors of one motion
RIGID_RANGE: Final = 0.01  # range of angles that is too small for any flight [rad]
STIFF: Final = 0.03  # the same, of a vehicle that accelerates too much for its lean [rad]
LEANLESS: Final = 5.0  # acceleration by lean that is too much, by gravity
TRAVEL: Final = 0.5  # extent of a flight whose angles cannot stay that small [m]
TUMBLING: Final = 5.0  # usual rates of a vehicle that is not upright [rad/s]
FAST_TURNING: Final = 2.0  # least usual rates at which angles can be 57.3 times too large [rad/s]
HALF_TURN_AS_RADIANS: Final = 0.06  # half a turn, 57.3 times too small [rad]
FOLLOWED_COSINE: Final = 0.7  # cosine of a velocity that agrees with larger angles, if late
COSINE_GAIN: Final = 0.02  # change of a cosine that tells one reading from another
NUMERIC: Final = 1e-5  # what a velocity without noise disagrees by, as it is interpolated
UNEXPLAINED_LEFT: Final = 0.6  # of what a velocity disagrees by, left with larger angles


def find_wrong_angle_unit(motion: PoseMotion) -> tuple[str, float] | None:
    """
    Return why the attitude is in the wrong unit, and the factor that corrects its angles.

    None if it is not.
    """
    turn = motion.turn
    if len(turn) < 100:
        return None
    small = magnify_angles(turn)
    if reason := _explain_small_angles(motion, small):
        return _describe_small_angles(reason), DEGREES_PER_RADIAN
    if _agrees_as_recorded(motion):
        return None
    pace = float(np.nanmedian(np.linalg.norm(motion.derive('rates'), axis=1)))
    if pace > TUMBLING and upright_share(turn) < 0.9:
        why = f'read as radians, the vehicle would tumble at {pace:.3g} rad/s'
        return _describe_large_angles(why), 1.0 / DEGREES_PER_RADIAN
    largest = float(np.max(np.abs(turn.as_euler('ZYX'))))
    if largest < HALF_TURN_AS_RADIANS and _explains(motion, small, 1.0 / DEGREES_PER_RADIAN):
        return _describe_small_angles(
            f'with larger ones {_name_agreement(motion)} agrees'
        ), DEGREES_PER_RADIAN
    if pace < FAST_TURNING and (upright_share(turn) > 0.5 or is_inverted(turn)):
        return None
    angles = shrink_angles(turn)
    for yaw in (
        np.arange(OFFSETS) * (FULL_TURN_RADIANS / DEGREES_PER_RADIAN)
        if motion.pose.velocity is not None
        else (0.0,)
    ):
        other = Rotation.from_euler('ZYX', angles + np.array([yaw, 0.0, 0.0]))
        if _explains(motion, other, DEGREES_PER_RADIAN):
            why = f'with smaller angles {_name_agreement(motion)} agrees'
            return _describe_large_angles(why), 1.0 / DEGREES_PER_RADIAN
    return None


def _describe_small_angles(why: str) -> str:
    return f'The angles are 57.3 times too small (radians read as degrees): {why}.'


def _describe_large_angles(why: str) -> str:
    return (
        f'The unit looks like deg: {why}; the angles are 57.3 times too large (degrees read as '
        'radians).'
    )


def _fit_velocity(motion: PoseMotion, turn: Rotation | None = None) -> ScaleFit:
    """Compare the velocity of a pose's topic with the derivative of its place."""
    velocity = motion.pose.velocity
    if velocity is None or motion.place is None:
        return NO_FIT
    measured = velocity.interpolate(motion.seconds)
    return fit_scale(measured, motion.derive('velocity', turn), motion.seconds, FILTER_DELAY)


def _fit_lean(motion: PoseMotion, turn: Rotation | None = None) -> ScaleFit:
    if motion.place is None:
        return NO_FIT
    return fit_tilt(motion.turn if turn is None else turn, motion.place, motion.seconds)


def _fit_rates(motion: PoseMotion, turn: Rotation | None = None) -> list[ScaleFit]:
    """Compare all rates that were recorded with the derivative of the attitude."""
    derived = motion.derive('rates', turn)
    return [fit_scale(one.values, derived, motion.seconds, FILTER_DELAY)
            for one in motion.list_vectors('rates')]  # fmt: skip


def _explain_small_angles(motion: PoseMotion, small: Rotation) -> str:
    """
    Return why the angles are too small, whatever the rates say; empty if they need not be.

    `small`: the attitude with angles 57.3 times as large. Rates in the wrong unit agree with it.
    """
    pose = motion.pose
    before, after = (_fit_velocity(motion, turn).cosine for turn in (None, small))
    left = 1.0 - before
    if after > FOLLOWED_COSINE and left > NUMERIC and 1.0 - after < UNEXPLAINED_LEFT * left:
        assert pose.velocity is not None
        return f"with larger ones '{pose.velocity.name}' agrees"
    turn = measure_turn(motion.turn, motion.seconds)
    if pose.position is None or not (pose.tracked and turn < STIFF):
        return ''
    lean = _fit_lean(motion)
    leans = abs(lean.cosine) > TILT_COSINE and lean.ratio > LEANLESS * STANDARD_GRAVITY
    extent = float(np.max(np.ptp(pose.position.values, axis=0)))
    # An attitude that does not change at all is another finding
    if extent < TRAVEL or not RIGID_RANGE / DEGREES_PER_RADIAN < turn < (
        STIFF if leans else RIGID_RANGE
    ):
        return ''
    if after < before - COSINE_GAIN:
        return ''
    return (
        f'yaw, pitch and roll stay within {DEGREES_PER_RADIAN * turn:.2g} degrees, while the '
        f'vehicle covers {extent:.2g} m'
    )


def _agrees_as_recorded(motion: PoseMotion) -> bool:
    """Return whether all that can be compared agrees, so that no other reading is needed."""
    speed, lean = _fit_velocity(motion), _fit_lean(motion)
    return (
        upright_share(motion.turn) > 0.9
        and (motion.pose.velocity is None or speed.cosine > SAME_MOTION_COSINE)
        and all(
            fit.cosine > SAME_MOTION_COSINE and is_near(fit.ratio, 1.0)
            for fit in _fit_rates(motion)
        )
        and (lean.cosine < TILT_COSINE or abs(np.log(lean.ratio / STANDARD_GRAVITY)) < 1.0)
    )


def _name_agreement(motion: PoseMotion) -> str:
    names = [vector.name for vector in motion.list_vectors('rates')[:1]]
    names += [motion.pose.velocity.name] if motion.pose.velocity is not None else []
    return f"'{names[0]}'" if names else 'an upright vehicle'


def _explains(motion: PoseMotion, turn: Rotation, excess: float) -> bool:
    """
    Return whether another reading of the attitude is right and the recorded one is not.

    `excess` is by how much the recorded angles are too large.
    """
    if upright_share(turn) < 0.9:
        return False
    votes = []
    before, after = _fit_velocity(motion), _fit_velocity(motion, turn)
    if (
        max(before.cosine, after.cosine) > SAME_MOTION_COSINE
        and abs(after.cosine - before.cosine) > COSINE_GAIN
    ):
        votes.append(after.cosine > before.cosine)
    lean = _fit_lean(motion), _fit_lean(motion, turn)
    if max(lean[0].cosine, lean[1].cosine) > TILT_COSINE:
        sizes = [abs(np.log(one.ratio / STANDARD_GRAVITY)) if one.cosine > TILT_COSINE else 9.0
                 for one in lean]  # fmt: skip
        votes.append(sizes[1] < 1.0 < sizes[0])
    recorded, reread = _fit_rates(motion), _fit_rates(motion, turn)
    matched = [fit for fit in reread if fit.cosine > SAME_MOTION_COSINE]
    if upright_share(motion.turn) < 0.5 and excess > 1.0:
        return bool(matched) or not reread or after.cosine > SAME_MOTION_COSINE
    # Rates that agree with the recorded angles are wrong too, or right
    for old, new in zip(recorded, reread, strict=True):
        if old.cosine > SAME_MOTION_COSINE and is_near(old.ratio, 1.0) and not votes:
            return False
        if (
            new.cosine > SAME_MOTION_COSINE
            and is_near(new.ratio, 1.0)
            and not is_near(old.ratio, 1.0)
        ):
            votes.append(True) if len(reread) > 1 or not votes else None
    return bool(votes) and all(votes)


REREAD: Final = 'reread'  # figure of a finding that explains the others of its topic
HIGHEST_RATE: Final = 5000.0  # messages of a tracker or an IMU per second [Hz]
LOWEST_RATE: Final = 0.5  # [Hz]
IMPOSSIBLE_ACCELERATION: Final = 40.0  # usual acceleration that no vehicle has [m/s2]
IMPOSSIBLE_SPEED: Final = 30.0  # usual speed that no indoor vehicle has [m/s]
IMPOSSIBLY_SLOW: Final = 0.003  # usual speed that no flight stays below [m/s]
MIN_TURNED: Final = 0.03  # least range of the angles of a flight [rad]
EXTENT_PER_TURN: Final = 0.2  # extent of a flight by the range of its angles, at least [m/rad]
CONTRADICTION: Final = 0.4  # cosine below which two vectors are not of one motion
BELOW_FLOOR: Final = -0.25  # median height at which all of a flight is below the floor [m]


def find_rereadings(evidence: CheckContext) -> list[QualityFinding]:
    """Return findings of wrong units of time, length and angle, and of z upside down."""
    # Nothing else can be judged with wrong times
    if wrong := [*_find_wrong_times(evidence)]:
        return wrong
    findings: list[QualityFinding] = []
    motions = {motion.pose.topic: motion for motion in evidence.motions}
    for pose in evidence.poses:
        motion = motions.get(pose.topic)
        if length := _explain_length(pose, motion):
            findings += _build_finding(pose.position, 'unit', length)
            continue
        if motion is not None:
            findings += _build_finding(pose.attitude, 'unit', find_wrong_angle_unit(motion))
        if motion is not None and is_inverted(motion.turn):
            words = (
                'The vehicle is upside down throughout: z of the map or of the body points down '
                '(NED or FRD read as ENU or FLU).'
            )
            findings += _build_finding(pose.attitude, 'axes', (words, -1.0))
        else:
            findings += _build_finding(pose.position, 'axes', _explain_vertical(pose, motion))
    return findings


def _build_finding(
    vector: VectorSeries | None, kind: str, reason: tuple[str, float] | None
) -> Iterator[QualityFinding]:
    """Yield the finding of a vector, by a sentence and its figure, if there is one."""
    if vector is not None and reason is not None:
        yield QualityFinding(
            kind, vector.name, float(vector.time[0]), float(vector.time[-1]), reason[0],
            Severity.SUSPICIOUS, {REREAD: reason[1]},
        )  # fmt: skip


def _find_wrong_times(evidence: CheckContext) -> Iterator[QualityFinding]:
    """Yield times whose rate no tracker or inertial sensor has."""
    vectors = [v for pose in evidence.poses for v in (pose.position, pose.attitude) if v]
    vectors += [v for sensor in evidence.inertials for v in (sensor.rates, sensor.force) if v]
    vectors = [v for v in vectors if len(v.time) >= limits.LEAST_SAMPLES]
    if not vectors:
        return
    quickest = min(vectors, key=lambda vector: median_period(vector.time))
    rate = 1.0 / median_period(quickest.time)
    if LOWEST_RATE <= rate <= HIGHEST_RATE:
        return
    wrong = 'short (seconds read as milliseconds)'
    words = f'{rate:.4g} messages per second'
    if rate < LOWEST_RATE:
        wrong, words = 'long (milliseconds read as seconds)', f'a message every {1.0 / rate:.4g} s'
    text = (
        f'The unit of the time looks wrong: {words} over {np.ptp(quickest.time):.4g} s. The times '
        f'are 1000 times too {wrong}.'
    )
    yield from _build_finding(quickest, 'unit', (text, rate))


def _explain_length(pose: PoseSeries, motion: PoseMotion | None) -> tuple[str, float] | None:
    """Return why a position is 1000 times too large or too small, and the figure."""
    place = pose.position
    if place is None or len(place.time) < 100:
        return None
    fits = [NO_FIT if motion is None else _fit_velocity(motion), _fit_speed(pose)]
    best = max(fits, key=lambda fit: fit.cosine)
    speed, pull = _measure_motion(place)
    large, small = '1000 times too large', '1000 times too small (metres read as millimetres)'
    if best.cosine > SAME_MOTION_COSINE and pose.tracked and pose.velocity is not None:
        why = f"'{pose.velocity.name}' is {best.ratio:.4g} times its derivative"
        if is_near(best.ratio, 1e-3):
            return f'The unit looks like mm: {why}; the values are {large}.', best.ratio
        if is_near(best.ratio, 1e3) and best.ratio * speed < IMPOSSIBLE_SPEED:
            return f'{why}: the values of the position are {small}.', best.ratio
    if (speed > IMPOSSIBLE_SPEED or pull > IMPOSSIBLE_ACCELERATION) and pose.tracked:
        why = f'the position would move at {speed:.3g} m/s and accelerate by {pull:.3g} m/s2'
        return f'The unit looks like mm: if it were m, {why}; the values are {large}.', speed
    extents = np.ptp(place.values, axis=0)
    # A position that does not change at all is another finding
    if motion is None or speed >= IMPOSSIBLY_SLOW or not extents.min() > 0.0:
        return None
    extent, turn = float(extents.max()), measure_turn(motion.turn, motion.seconds)
    if turn <= MIN_TURNED or extent >= EXTENT_PER_TURN * min(turn, 1.0):
        return None
    why = f'stays within {1e3 * extent:.3g} mm and moves at {1e3 * speed:.3g} mm/s, while the'
    return f'The position {why} vehicle turns by {turn:.2g} rad: the values are {small}.', extent


def _fit_speed(pose: PoseSeries) -> ScaleFit:
    """Compare the sizes of velocity and of the derivative of the position, without an attitude."""
    if pose.position is None or pose.velocity is None:
        return NO_FIT
    time = pose.position.time
    speed = np.linalg.norm(differentiate(pose.position.values, time), axis=1, keepdims=True)
    logged = np.linalg.norm(pose.velocity.interpolate(time), axis=1, keepdims=True)
    return fit_scale(logged, speed, time, FILTER_DELAY)


def _measure_motion(place: VectorSeries) -> tuple[float, float]:
    """Return the usual speed and acceleration [m/s], [m/s2]."""
    step = median_period(place.time)
    calm = smooth_columns(place.values, hann_kernel(0.5, step))
    speed = np.gradient(calm, place.time, axis=0)
    pull = np.gradient(smooth_columns(speed, hann_kernel(0.5, step)), place.time, axis=0)
    return (
        float(np.percentile(np.linalg.norm(speed, axis=1), 75.0)),
        float(np.percentile(np.linalg.norm(pull, axis=1), 75.0)),
    )


def _explain_vertical(pose: PoseSeries, motion: PoseMotion | None) -> tuple[str, float] | None:
    """Return why the z axes of a pose point down, and its median height [m]."""
    place = pose.position
    if place is None or not pose.tracked or len(place.time) < limits.LEAST_SAMPLES:
        return None
    # A whole pose with z down agrees with itself; one wrong vector does not
    turns = [] if motion is None else [*_fit_rates(motion), _fit_velocity(motion)]
    if any(fit.cosine < CONTRADICTION for fit in turns if np.isfinite(fit.ratio)):
        return None
    by_tilt, lean = 0, NO_FIT
    if motion is not None and motion.place is not None:
        by_tilt, lean = judge_tilt(motion.turn, motion.place, motion.seconds)
    by_height, _ = judge_heights(place.values)
    low = float(np.median(place.values[:, 2]))
    reasons = []
    if by_height < 0 and low < BELOW_FLOOR:
        reasons.append(f'z is below zero throughout (median {low:.3g} m)')
    # With z down, heights that are all above zero would be below the floor
    if by_tilt < 0 and by_height <= 0:
        reasons.append(f'the vehicle accelerates against its lean (correlation {lean.cosine:.2f})')
    text = f'The z axis points down (NED read as ENU): {" and ".join(reasons)}.'
    return (text, low) if reasons else None


def remove_explained_findings(findings: list[QualityFinding]) -> list[QualityFinding]:
    """Drop what a wrong unit or axis of the whole topic also causes there."""
    in_degrees = {
        finding.channel
        for finding in findings
        if finding.kind == 'unit' and 'looks like deg:' in finding.evidence
    }
    # An attitude in degrees also has the vehicle on its side
    findings = [
        finding
        for finding in findings
        if finding.kind != 'axes' or finding.channel not in in_degrees
    ]
    causes = [finding for finding in findings if REREAD in finding.values]
    if not causes:
        return findings
    topics = {finding.channel.split('/')[0] for finding in causes}
    everywhere = any('unit of the time' in finding.evidence for finding in causes)
    implied = ('impossible', 'unit', 'axes', 'clock', 'stamps', 'held')
    return [
        finding
        for finding in findings
        if finding in causes
        or finding.kind not in implied
        or not (everywhere or _shares_topic(finding, topics))
    ]


def _shares_topic(finding: QualityFinding, topics: set[str]) -> bool:
    """Return whether a finding is in one of the topics, or compares another with it."""
    compared = any(topic in finding.evidence for topic in topics)
    return finding.channel.split('/')[0] in topics or (finding.kind != 'impossible' and compared)
