"""
Detect a log that was read with the wrong unit of time, length or angle, or with z upside down.

Each is a reading of the whole topic, so that one cause has one finding: times 1000 times too
short make a vehicle fast, its turns quick and its clock late, but only the times are wrong. Of
angles in degrees and in radians, one agrees with velocity, rates and the lean of an accelerating
vehicle; rates may be in the wrong unit, too, and late by a filter.
"""

from collections.abc import Iterator
from typing import Final

from lta_config.constants import STANDARD_GRAVITY
from lta_data.data_quality import limits
from lta_data.data_quality.finding import QualityFinding, Severity
from lta_data.data_quality.motion import PoseSeries, VectorSeries
from lta_data.data_quality.motion_scales import (
    ALIKE,
    covers_place,
    DEGREES,
    fit_lever,
    fit_rates,
    fit_speed,
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
    VectorFit,
)
from lta_data.data_quality.recording import CheckContext
from lta_data.data_quality.smoothing import hann_kernel, median_period, smooth_columns
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


REREAD: Final = 'reread'  # figure of a finding that explains the others of its topic
FASTEST: Final = 5000.0  # messages of a tracker or an IMU per second [Hz]
SLOWEST: Final = 0.5  # [Hz]
QUICK: Final = 40.0  # usual acceleration that no vehicle has [m/s2]
FAST: Final = 30.0  # usual speed that no indoor vehicle has [m/s]
SLOW: Final = 0.003  # usual speed that no flight stays below [m/s]
TURNED: Final = 0.03  # least range of the angles of a flight [rad]
REACH: Final = 0.2  # extent of a flight by the range of its angles, at least [m/rad]
CONTRADICTION: Final = 0.4  # cosine below which two vectors are not of one motion
BELOW: Final = -0.25  # median height at which all of a flight is below the floor [m]
LEVER: Final = 0.6  # largest distance of markers from the axis of a swing [m]


def find_rereadings(evidence: CheckContext) -> list[QualityFinding]:
    """Return findings of wrong units of time, length and angle, and of z upside down."""
    findings = [*_find_wrong_times(evidence)]
    # Nothing else can be judged with wrong times
    if findings:
        return findings
    for pose in evidence.poses:
        lengths = [*_find_wrong_length(pose)]
        findings += lengths or [*_find_wrong_angles(pose, evidence)]
        if not lengths:
            findings += _find_wrong_vertical(pose, evidence)
    return findings


def _build_finding(
    vector: VectorSeries, kind: str, sentence: str, figure: float
) -> QualityFinding:
    return QualityFinding(
        kind, vector.name, float(vector.time[0]), float(vector.time[-1]), sentence,
        Severity.SUSPICIOUS, {REREAD: figure},
    )  # fmt: skip


# Time


def _find_wrong_times(evidence: CheckContext) -> Iterator[QualityFinding]:
    """Yield times whose rate no tracker or inertial sensor has."""
    vectors = [v for pose in evidence.poses for v in (pose.position, pose.attitude) if v]
    vectors += [v for sensor in evidence.inertials for v in (sensor.rates, sensor.force) if v]
    vectors = [v for v in vectors if len(v.time) >= limits.LEAST_SAMPLES]
    if not vectors:
        return
    quickest = min(vectors, key=lambda vector: median_period(vector.time))
    rate = 1.0 / median_period(quickest.time)
    long = float(quickest.time[-1] - quickest.time[0])
    if rate > FASTEST:
        yield _build_finding(
            quickest, 'unit',
            f'The unit of the time looks wrong: {rate:.4g} messages per second over '
            f'{long:.3g} s. The times are 1000 times too short (seconds read as milliseconds).',
            rate,
        )  # fmt: skip
    elif rate < SLOWEST:
        yield _build_finding(
            quickest, 'unit',
            f'The unit of the time looks wrong: a message every {1.0 / rate:.4g} s over '
            f'{long:.4g} s. The times are 1000 times too long (milliseconds read as seconds).',
            rate,
        )  # fmt: skip


# Length


def _find_wrong_length(pose: PoseSeries) -> Iterator[QualityFinding]:
    """Yield a position 1000 times too large or too small."""
    if pose.position is None or len(pose.position.time) < 100 or not covers_place(pose):
        return
    fits = [fit_velocity(pose), fit_speed(pose)]
    best = max(fits, key=lambda fit: fit.cosine)
    place, speed, pull = pose.position, *_measure_motion(pose.position)
    if best.cosine > ALIKE and pose.tracked:
        wrong = [*_judge_against_velocity(pose, place, best, speed)]
        yield from wrong
        if wrong:
            return
    if (speed > FAST or pull > QUICK) and pose.tracked:
        yield _build_finding(
            place, 'unit',
            f'The unit looks like mm: if it were m, the position would move at {speed:.3g} m/s '
            f'and accelerate by {pull:.3g} m/s2; the values are 1000 times too large.',
            speed,
        )  # fmt: skip
        return
    extent = float(np.max(np.ptp(place.values, axis=0)))
    # A position that does not change at all is another finding
    if not float(np.min(np.ptp(place.values, axis=0))) > 0.0:
        return
    if pose.attitude is not None and speed < SLOW:
        turn = measure_turn(pose.attitude)
        if turn > TURNED and extent < REACH * min(turn, 1.0):
            yield _build_finding(
                place, 'unit',
                f'The position stays within {1e3 * extent:.3g} mm and moves at {1e3 * speed:.3g} '
                f'mm/s, while the vehicle turns by {turn:.2g} rad: the values are 1000 times too '
                'small (metres read as millimetres).',
                extent,
            )  # fmt: skip


def _measure_motion(place: VectorSeries) -> tuple[float, float]:
    """Return the usual speed and acceleration. [m/s], [m/s2]"""
    step = median_period(place.time)
    calm = smooth_columns(place.values, hann_kernel(0.5, step))
    speed = np.gradient(calm, place.time, axis=0)
    pull = np.gradient(smooth_columns(speed, hann_kernel(0.5, step)), place.time, axis=0)
    return (
        float(np.percentile(np.linalg.norm(speed, axis=1), 75.0)),
        float(np.percentile(np.linalg.norm(pull, axis=1), 75.0)),
    )


def _judge_against_velocity(
    pose: PoseSeries, place: VectorSeries, fit: VectorFit, speed: float
) -> Iterator[QualityFinding]:
    """Yield the position that is off by 1000 against the velocity in the same topic."""
    assert pose.velocity is not None
    if is_near(fit.factor, 1e-3):
        yield _build_finding(
            place, 'unit',
            f"The unit looks like mm: '{pose.velocity.name}' is {fit.factor:.4g} times its "
            'derivative; the values are 1000 times too large.',
            fit.factor,
        )  # fmt: skip
    elif is_near(fit.factor, 1e3) and fit.factor * speed < FAST:
        yield _build_finding(
            place, 'unit',
            f"'{pose.velocity.name}' is {fit.factor:.4g} times its derivative: the values of the "
            'position are 1000 times too small (metres read as millimetres).',
            fit.factor,
        )  # fmt: skip


# Angle


def _find_wrong_angles(pose: PoseSeries, evidence: CheckContext) -> Iterator[QualityFinding]:
    """Yield an attitude in the wrong unit, if another reading agrees with all the rest."""
    rates = [pose.turning] if pose.turning is not None else []
    rates += [sensor.rates for sensor in evidence.inertials if sensor.rates is not None]
    wrong = find_wrong_angle_unit(pose, rates)
    if wrong is not None:
        assert pose.attitude is not None
        yield _build_finding(pose.attitude, 'unit', *wrong)


# Vertical


def _find_wrong_vertical(pose: PoseSeries, evidence: CheckContext) -> Iterator[QualityFinding]:
    """Yield a pose whose z axes point down."""
    place, attitude = pose.position, pose.attitude
    enough = limits.LEAST_SAMPLES
    if attitude is not None and len(attitude.time) >= enough and is_inverted(attitude.values):
        yield _build_finding(
            attitude, 'axes',
            'The vehicle is upside down throughout: z of the map or of the body points down '
            '(NED or FRD read as ENU or FLU).', -1.0,
        )  # fmt: skip
        return
    if place is None or not pose.tracked or len(place.time) < enough:
        return
    # A whole pose with z down agrees with itself; one wrong vector does not
    turns = [fit_rates(pose, pose.turning)] if pose.turning is not None else []
    turns += [fit_velocity(pose)] if pose.velocity is not None else []
    if any(fit.cosine < CONTRADICTION for fit in turns if np.isfinite(fit.factor)):
        return
    lean = fit_tilt(pose)
    least, low, high = np.percentile(place.values[:, 2], [2.0, 50.0, 98.0])
    below = bool(low < BELOW and high < 0.0)
    # With z down, heights that are all above zero would be below the floor
    against = (
        lean.cosine < -TILT
        and least < 0.0
        and is_near(lean.factor / STANDARD_GRAVITY, 1.0)
        and not _swings_with_body(pose)
    )
    if below or against:
        reasons = [f'z is below zero throughout (median {low:.3g} m)'] if below else []
        if against:
            reasons.append(
                f'the vehicle accelerates against its lean (correlation {lean.cosine:.2f})'
            )
        yield _build_finding(
            place, 'axes',
            f'The z axis points down (NED read as ENU): {" and ".join(reasons)}.', float(low),
        )  # fmt: skip


def _swings_with_body(pose: PoseSeries) -> bool:
    """Return whether the tracked point moves as one above the axis of a swinging body does."""
    lever = fit_lever(pose)
    return lever.cosine > TILT and 0.0 < lever.factor < LEVER


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
