# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A tf listener of our own over a bag: what tf2 does, written anew with SciPy."""

from bisect import bisect_right

from lta_bag.reader import Bag
import numpy as np
from scipy.spatial.transform import Rotation, Slerp

NS = 1_000_000_000


def nanoseconds(stamp) -> int:
    return stamp.sec * NS + stamp.nanosec


class FrameTree:
    """
    The frames of a bag over time.

    Attributes
    ----------
    parents : dict of str to str
        By child frame; one parent each, or the tree is torn.
    begin, end : int
        Time within which all moving frames are known. [ns]

    """

    def __init__(self, bag: Bag) -> None:
        self.parents: dict[str, str] = {}
        self._moving: dict[str, tuple[list[int], list, list]] = {}
        self._fixed: dict[str, tuple[Rotation, np.ndarray]] = {}
        for topic, _, data in bag.iterate_messages(['/tf', '/tf_static']):
            for item in bag.decode(topic, data).transforms:
                child, parent = item.child_frame_id, item.header.frame_id
                assert self.parents.setdefault(child, parent) == parent, f'{child} has two parents'
                p, q = item.transform.translation, item.transform.rotation
                place, turn = np.array([p.x, p.y, p.z]), Rotation.from_quat([q.x, q.y, q.z, q.w])
                if topic == '/tf_static':
                    self._fixed[child] = turn, place
                else:
                    stamps, turns, places = self._moving.setdefault(child, ([], [], []))
                    stamps.append(nanoseconds(item.header.stamp))
                    turns.append(turn)
                    places.append(place)
        for stamps, _, _ in self._moving.values():
            assert stamps == sorted(set(stamps))
        self.begin = max(stamps[0] for stamps, _, _ in self._moving.values())
        self.end = min(stamps[-1] for stamps, _, _ in self._moving.values())

    def step_up(self, frame: str, at: int) -> tuple[Rotation, np.ndarray]:
        """Return attitude and place of a frame in its parent at a time [ns, m]."""
        if frame in self._fixed:
            return self._fixed[frame]
        stamps, turns, places = self._moving[frame]
        assert stamps[0] <= at <= stamps[-1], f'{frame} is not known at {at}'
        after = bisect_right(stamps, at)
        if stamps[after - 1] == at:
            return turns[after - 1], places[after - 1]
        share = (at - stamps[after - 1]) / (stamps[after] - stamps[after - 1])
        between = Slerp([0.0, 1.0], Rotation.concatenate(turns[after - 1 : after + 1]))(share)
        return between, (1.0 - share) * places[after - 1] + share * places[after]

    def locate(self, frame: str, at: int) -> tuple[Rotation, np.ndarray]:
        """Return attitude and place of a frame in the map at a time [ns, m]."""
        turn, place = Rotation.identity(), np.zeros(3)
        while frame != 'map':
            assert frame in self.parents, f'{frame} has no parent'
            up, shift = self.step_up(frame, at)
            turn, place = up * turn, up.apply(place) + shift
            frame = self.parents[frame]
        return turn, place


def resolve_all(bag: Bag, cut: bool = False) -> set[str]:
    """
    Resolve each frame of each message of a bag to the map at its stamp; return the frames.

    A flight that was cut off may have messages before its first transform and after its last.
    """
    tree, found = FrameTree(bag), set()
    for topic, _, data in bag.iterate_messages([name for name in bag.topics if name[1:3] != 'tf']):
        message = bag.decode(topic, data)
        for part in getattr(message, 'markers', [message]):
            if not hasattr(part, 'header'):
                continue
            at = nanoseconds(part.header.stamp)
            if cut and at and not tree.begin <= at <= tree.end:
                continue
            for frame in {part.header.frame_id, getattr(part, 'child_frame_id', '')} - {''}:
                tree.locate(frame, at)
                found.add(frame)
    return found
