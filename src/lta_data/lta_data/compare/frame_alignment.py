# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Transform B's positions, headings and vectors to A's frames if the frames differ."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
import math
from typing import Final, final, Literal, NamedTuple

from lta_data.compare.channel_comparison import ChannelPair
from lta_data.compare.sampling import align_signals, Array, wrap_angle
import numpy as np

REWEIGHTING_ROUNDS: Final = 50  # iterations, at most
TUKEY: Final = 4.685  # scaled residuals of zero weight; 95 % efficiency for normal noise
MIN_PATH_SPREAD: Final = 0.05  # m of horizontal spread needed to estimate the rotation
TELLING_SPREAD: Final = 3.0  # least ratio of that spread to the misfit


@final
@dataclass(frozen=True, slots=True)
class FrameTransform:
    """Transformation of positions of B into A's frame: rotation about z, then a shift."""

    yaw: float  # [rad]
    # Shift after the rotation [m]
    x: float
    y: float
    z: float
    # RMS distance of the paths without and with the transformation [m]
    before: float = 0.0
    after: float = 0.0
    # Whether the rotation comes from the headings because the path is too short
    by_heading: bool = False

    def transform_positions(self, xyz: Array) -> Array:
        """Return positions of B, shape (n, 3), in A's frame [m]."""
        x, y = self.rotate_vectors(xyz[:, 0], xyz[:, 1])
        return np.stack([x + self.x, y + self.y, xyz[:, 2] + self.z], axis=1)

    def rotate_vectors(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Return horizontal vectors of B, x and y of shape (n,), in A's frame."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return c * x - s * y, s * x + c * y


def fit_frame_transform(
    a: Array, b: Array, heading_a: Array | None = None, heading_b: Array | None = None
) -> FrameTransform | None:
    """
    Fit the transformation of B's path to A's; None for fewer than three common positions.

    Least squares of the distance over rotation and shift (Umeyama 1991, "Least-squares
    estimation of transformation parameters between two point patterns", for a rotation about z).
    Tukey weights keep a stretch in which the flights diverge from biasing the rest.

    `a`, `b`, shape (n, 3): positions at the same times [m]. `heading_a`, `heading_b`, shape (n,):
    yaw at the same times, used if the path is too short [rad].
    """
    finite = np.isfinite(a).all(axis=1) & np.isfinite(b).all(axis=1)
    # Two points always fit a rotation and a shift, so they test nothing
    if finite.sum() < 3:
        return None
    a, b = a[finite], b[finite]
    even = np.ones(len(a))
    fit = fit_shift(a, b, fit_yaw(a, b, even), even)
    # Heights need no rotation, so that their median begins where most of the flight is
    fit = replace(fit, z=float(np.median(a[:, 2] - b[:, 2])))
    for _ in range(REWEIGHTING_ROUNDS):
        apart = np.linalg.norm(a - fit.transform_positions(b), axis=1)
        # 1.4826: standard deviation from the median absolute deviation of normal noise.
        scale = 1.4826 * float(np.median(apart))
        if scale <= 1e-12:
            break
        # Tukey's biweight.
        weight = np.maximum(0.0, 1.0 - (apart / (TUKEY * scale)) ** 2) ** 2
        last, fit = fit, fit_shift(a, b, fit_yaw(a, b, weight), weight)
        if abs(wrap_angle(np.array(fit.yaw - last.yaw))) < 1e-12:
            break
    # RMS distance from the mean position
    way = math.sqrt(float(np.sum(np.var(a[:, :2], axis=0))))
    apart = np.linalg.norm((a - fit.transform_positions(b))[:, :2], axis=1)
    # A hover has no shape from which a rotation could be estimated.
    if way < max(MIN_PATH_SPREAD, TELLING_SPREAD * 1.4826 * float(np.median(apart))):
        fit = fit_shift(a, b, mean_heading_difference(heading_a, heading_b), even)
        fit = replace(fit, by_heading=True)
    return replace(
        fit, before=rms_distance(a, b), after=rms_distance(a, fit.transform_positions(b))
    )


def rms_distance(a: Array, b: Array) -> float:
    """Return the RMS distance of two paths of shape (n, 3)."""
    return math.sqrt(float(np.mean(np.sum((a - b) ** 2, axis=1))))


def fit_yaw(a: Array, b: Array, weight: Array) -> float:
    """Fit the rotation about z by weighted least squares [rad]."""
    (ax, ay, _), (bx, by, _) = (
        (part - np.average(part, axis=0, weights=weight)).T for part in (a, b)
    )
    # Closed-form rotation in the plane: sum of cross products over sum of dot products
    return math.atan2(
        float(np.sum(weight * (bx * ay - by * ax))), float(np.sum(weight * (bx * ax + by * ay)))
    )


def fit_shift(a: Array, b: Array, yaw: float, weight: Array) -> FrameTransform:
    """Return a rotation with the shift that remains after it."""
    turned = FrameTransform(yaw, 0.0, 0.0, 0.0)
    left = np.average(a - turned.transform_positions(b), axis=0, weights=weight)
    return FrameTransform(yaw, *left.tolist())


def mean_heading_difference(a: Array | None, b: Array | None) -> float:
    """Return the circular mean of the difference of headings; zero without headings [rad]."""
    if a is None or b is None:
        return 0.0
    turn = a - b
    turn = turn[np.isfinite(turn)]
    if not len(turn):
        return 0.0
    return math.atan2(float(np.mean(np.sin(turn))), float(np.mean(np.cos(turn))))


Frames = Literal['auto', 'given', 'fit']
BODY_FRAME_ENDING: Final = 'link'  # frames that move with the robot end in it, after REP-105
ODOMETRY: Final = 'nav_msgs/msg/Odometry'
# Remaining share of the distance from which frames count as different
FRAMES_DIFFER_SHARE: Final = 0.2
PLACE_AXES: Final = ('x', 'y', 'z')


class PositionPair(NamedTuple):
    """A position that both flights have: prefix of its fields, topic, frames and priority."""

    field: str
    topic: str
    frames: tuple[str, str]
    weight: tuple[bool, int]


@final
@dataclass(frozen=True, slots=True)
class FrameAlignment:
    """What was done about one pair of frames."""

    frames: tuple[str, str]  # A's and B's
    topic: str  # A's topic whose positions were used
    fit: FrameTransform | None  # transformation from B to A; None with too few positions
    applied: bool  # whether it was applied
    reason: str  # one sentence


def align_frames(
    pairs: Sequence[ChannelPair],
    types: Mapping[str, str],
    timing_kind: str,
    frames: Frames = 'auto',
) -> tuple[list[ChannelPair], list[FrameAlignment]]:
    """
    Return the pairs, whose B has A's clock, with B in A's frames, and what was done.

    `timing_kind`: `how` of the alignment of time. `types`: message types of A's topics, as far as
    they are known.
    `frames` is 'given': unchanged; 'fit': fit each world frame of B to A's; 'auto': fit only if
    the frames have different names, or if the data of one run recorded twice show a difference.
    """
    by_name = {pair.name: pair for pair in pairs}
    best: dict[tuple[str, str], PositionPair] = {}
    for pose in find_world_positions(pairs, types):
        held = best.get(pose.frames)
        # Per pair of frames, prefer odometry, then the topic with the most messages
        if held is None or pose.weight > held.weight:
            best[pose.frames] = pose
    done = [fit_frame_alignment(pose, by_name, timing_kind, frames) for pose in best.values()]
    moved = dict(by_name)
    for each in done:
        if each.applied and each.fit is not None:
            moved |= transform_pairs(by_name, each.frames, each.fit)
    return list(moved.values()), done


def find_world_positions(
    pairs: Sequence[ChannelPair], types: Mapping[str, str]
) -> list[PositionPair]:
    """Return the positions that are in a world frame."""
    names = {pair.name for pair in pairs}
    starts = []
    for pair in pairs:
        start = pair.name.removesuffix('position.x')
        whole = {f'{start}position.{axis}' for axis in PLACE_AXES} <= names
        frames = pair.frames
        # Frames named ..._link move with the robot (REP-105); only world frames are fitted.
        if (
            start == pair.name
            or not whole
            or any(each.endswith(BODY_FRAME_ENDING) for each in frames)
        ):
            continue
        kind = types.get(pair.a.topic)
        starts.append(
            PositionPair(start, pair.a.topic, frames, (kind == ODOMETRY, len(pair.a.time)))
        )
    return starts


def fit_frame_alignment(
    pose: PositionPair, pairs: Mapping[str, ChannelPair], timing_kind: str, frames: Frames
) -> FrameAlignment:
    """Fit the transformation of one pair of frames and decide whether to apply it."""
    both = [pairs[f'{pose.field}position.{axis}'] for axis in PLACE_AXES]
    joined = [align_signals(*pair.signals) for pair in both]
    heading = pairs.get(f'{pose.field}orientation.yaw')
    yaws: tuple[Array | None, Array | None] = (None, None)
    if heading is not None:
        turn = align_signals(*heading.signals, angular=True)
        yaws = turn.a, turn.b
    fit = fit_frame_transform(
        np.stack([each.a for each in joined], axis=1),
        np.stack([each.b for each in joined], axis=1),
        *yaws,
    )
    return FrameAlignment(
        pose.frames, pose.topic, fit, *decide_alignment(pose.frames, fit, timing_kind, frames)
    )


def decide_alignment(
    names: tuple[str, str], fit: FrameTransform | None, timing_kind: str, frames: Frames
) -> tuple[bool, str]:
    """Return whether to apply a transformation, and why."""
    if fit is None:
        return False, 'The flights have too few positions in common to compare the frames.'
    if frames != 'auto':
        return frames == 'fit', 'As requested with --frames.'
    labels = [f"'{name}'" if name else 'an unnamed frame' for name in names]
    if names[0] != names[1]:
        return True, f'The frames differ: A uses {labels[0]}, B uses {labels[1]}.'
    # The same frame name is trusted unless a fit removes most of the distance.
    better = fit.after < FRAMES_DIFFER_SHARE * fit.before
    # Two different runs may differ in position; one run recorded twice may not.
    if better and timing_kind == 'clock':
        return True, (
            f'A and B show the same run, but their paths are {fit.before:.2f} m apart without '
            f'this transformation and {fit.after:.2f} m with it.'
        )
    if better:
        return False, (
            f'Both use {labels[0]}. Rotating and shifting B would reduce the distance between the '
            f'paths from {fit.before:.2f} m to {fit.after:.2f} m; to do so, use --frames fit.'
        )
    return False, f'Both use {labels[0]}.'


def transform_pairs(
    pairs: Mapping[str, ChannelPair], frames: tuple[str, str], fit: FrameTransform
) -> dict[str, ChannelPair]:
    """Return the pairs in these frames, with B transformed."""
    transformed: dict[str, ChannelPair] = {}
    for name, pair in pairs.items():
        if pair.frames != frames:
            continue
        if name.endswith('orientation.yaw'):
            # Frames differ in yaw only (gravity fixes the rest), so roll and pitch stay
            turned = wrap_angle(pair.b.values + fit.yaw)
            transformed[name] = pair._replace(b=replace(pair.b, values=turned))
        for kind in ('position', 'vector'):
            start = name.removesuffix(f'{kind}.x')
            parts = [pairs.get(f'{start}{kind}.{axis}') for axis in PLACE_AXES]
            if start != name:
                whole = [part for part in parts if part is not None]
                if len(whole) == len(PLACE_AXES):
                    transformed |= transform_triple(whole, fit, kind == 'position')
    return transformed


def transform_triple(
    parts: Sequence[ChannelPair], fit: FrameTransform, position: bool
) -> dict[str, ChannelPair]:
    """Return x, y and z of B, rotated, and for a position also shifted."""
    rows = np.stack([pair.b.values for pair in parts], axis=1)
    if position:
        values = fit.transform_positions(rows)
    else:
        # Vectors are rotated only; a shift applies to positions.
        x, y = fit.rotate_vectors(rows[:, 0], rows[:, 1])
        values = np.stack([x, y, rows[:, 2]], axis=1)
    return {
        pair.name: pair._replace(b=replace(pair.b, values=column))
        for pair, column in zip(parts, values.T, strict=True)
    }
