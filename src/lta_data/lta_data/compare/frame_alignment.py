"""Transform B's positions, headings and vectors to A's frames if the frames differ."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, final, Literal, NamedTuple

from lta_data.compare.channel_pairs import ChannelPair
from lta_data.compare.compared_flight import ComparedFlight
from lta_data.compare.frame_fit import fit_frame_transform, FrameTransform
from lta_data.compare.sampling import align_signals, Array, sort_samples, wrap_angle
from lta_data.compare.time_alignment import TimeAlignment
import numpy as np

Frames = Literal['auto', 'given', 'fit']
BODY: Final = 'link'  # frames that move with the robot end in it, after REP-105
ODOMETRY: Final = 'nav_msgs/msg/Odometry'
BETTER: Final = 0.2  # remaining share of the distance from which frames count as different
AXES: Final = ('x', 'y', 'z')


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
    a: ComparedFlight,
    b: ComparedFlight,
    pairs: Sequence[ChannelPair],
    timing: TimeAlignment,
    frames: Frames = 'auto',
) -> tuple[list[ChannelPair], list[FrameAlignment]]:
    """
    Return the pairs with B in A's frames, and what was done.

    `frames` is 'given': unchanged; 'fit': fit each world frame of B to A's; 'auto': fit only if
    the frames have different names, or if the data of one run recorded twice show a difference.
    """
    by_name = {pair.name: pair for pair in pairs}
    best: dict[tuple[str, str], PositionPair] = {}
    for pose in find_world_positions(a, b, pairs):
        held = best.get(pose.frames)
        # Per pair of frames, prefer odometry, then the topic with the most messages
        if held is None or pose.weight > held.weight:
            best[pose.frames] = pose
    done = [fit_frame_alignment(pose, by_name, timing, frames) for pose in best.values()]
    moved = dict(by_name)
    for each in done:
        if each.applied and each.fit is not None:
            moved |= transform_pairs(a, b, by_name, each.frames, each.fit)
    return list(moved.values()), done


def find_pair_frames(a: ComparedFlight, b: ComparedFlight, pair: ChannelPair) -> tuple[str, str]:
    """Return the frames of both channels of a pair."""
    of_a, of_b = a.topics.get(pair.a.topic), b.topics.get(pair.b.topic)
    return '' if of_a is None else of_a.frame, '' if of_b is None else of_b.frame


def find_world_positions(
    a: ComparedFlight, b: ComparedFlight, pairs: Sequence[ChannelPair]
) -> list[PositionPair]:
    """Return the positions that are in a world frame."""
    names = {pair.name for pair in pairs}
    starts = []
    for pair in pairs:
        start = pair.name.removesuffix('position.x')
        whole = {f'{start}position.{axis}' for axis in AXES} <= names
        frames = find_pair_frames(a, b, pair)
        # Frames named ..._link move with the robot (REP-105); only world frames are fitted.
        if start == pair.name or not whole or any(each.endswith(BODY) for each in frames):
            continue
        kind = a.topics[pair.a.topic].type_name
        starts.append(
            PositionPair(start, pair.a.topic, frames, (kind == ODOMETRY, len(pair.a.time)))
        )
    return starts


def fit_frame_alignment(
    pose: PositionPair, pairs: Mapping[str, ChannelPair], timing: TimeAlignment, frames: Frames
) -> FrameAlignment:
    """Fit the transformation of one pair of frames and decide whether to apply it."""
    both = [pairs[f'{pose.field}position.{axis}'] for axis in AXES]
    joined = [
        align_signals(
            sort_samples(pair.a.time, pair.a.values),
            # Clocks first: a time offset of a moving vehicle looks like a shift of the frame
            sort_samples(timing.convert_to_a_time(pair.b.time), pair.b.values),
        )
        for pair in both
    ]
    heading = pairs.get(f'{pose.field}orientation.yaw')
    yaws: tuple[Array | None, Array | None] = (None, None)
    if heading is not None:
        turn = align_signals(
            sort_samples(heading.a.time, heading.a.values),
            sort_samples(timing.convert_to_a_time(heading.b.time), heading.b.values),
            angular=True,
        )
        yaws = turn.a, turn.b
    fit = fit_frame_transform(
        np.stack([each.a for each in joined], axis=1),
        np.stack([each.b for each in joined], axis=1),
        *yaws,
    )
    return FrameAlignment(
        pose.frames, pose.topic, fit, *decide_alignment(pose.frames, fit, timing, frames)
    )


def decide_alignment(
    names: tuple[str, str], fit: FrameTransform | None, timing: TimeAlignment, frames: Frames
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
    better = fit.after < BETTER * fit.before
    # Two different runs may differ in position; one run recorded twice may not.
    if better and timing.how == 'clock':
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
    a: ComparedFlight,
    b: ComparedFlight,
    pairs: Mapping[str, ChannelPair],
    frames: tuple[str, str],
    fit: FrameTransform,
) -> dict[str, ChannelPair]:
    """Return the pairs in these frames, with B transformed."""
    transformed: dict[str, ChannelPair] = {}
    for name, pair in pairs.items():
        if find_pair_frames(a, b, pair) != frames:
            continue
        if name.endswith('orientation.yaw'):
            # Frames differ in yaw only (gravity fixes the rest), so roll and pitch stay
            turned = wrap_angle(pair.b.values + fit.yaw)
            transformed[name] = pair._replace(b=replace(pair.b, values=turned))
        for kind in ('position', 'vector'):
            start = name.removesuffix(f'{kind}.x')
            parts = [pairs.get(f'{start}{kind}.{axis}') for axis in AXES]
            if start != name:
                whole = [part for part in parts if part is not None]
                if len(whole) == len(AXES):
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
