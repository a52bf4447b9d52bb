"""The goal of a flight: the lamps to be reached, in their order, and when each was."""

from lta_analysis.report.curves import Array, Motion, Spot
from lta_analysis.report.evidence import Evidence
import numpy as np


def stops(view: Evidence) -> list[Spot]:
    """Return the lamps of the route in their order, or the one lamp; none where none is known."""
    scenario = view.scene.scenario
    if view.lamp is None or scenario is None:
        return []
    return [Spot(*lamp.position.vector[:2]) for lamp in scenario.stops]


def radius(view: Evidence) -> float:
    """Return how near counts as reached; NaN where it is not known. [m]"""
    return np.nan if view.scene.scenario is None else view.scene.scenario.goal.radius.si


def arrivals(view: Evidence) -> list[float]:
    """
    Return when each lamp was truly reached, one after the other, as far as they were. [s]

    A lamp counts in its turn only: a round that ends where it began is not over at the start.
    """
    truth, near, found, since = view.truth, radius(view), list[float](), 0
    for lamp in stops(view):
        there = np.hypot(lamp.x - truth.x[since:], lamp.y - truth.y[since:]) <= near
        if not there.any():
            break
        since += int(there.argmax()) + 1
        found.append(float(truth.time[since - 1]))
    return found


def turn(view: Evidence, time: Array) -> Array:
    """Return which of the lamps is next at each instant, from 0. [s]"""
    return np.minimum(np.searchsorted(arrivals(view), time), len(stops(view)) - 1)


def distance(view: Evidence, motion: Motion) -> Array:
    """Return the horizontal distance to the lamp that is next, NaN where none is known. [m]"""
    ahead, left = _way(view, motion)
    return np.hypot(ahead, left)


def direction(view: Evidence, motion: Motion) -> Array:
    """Return the direction to the lamp that is next, in the body frame. [rad]"""
    ahead, left = _way(view, motion)
    return wrapped(np.arctan2(left, ahead) - motion.yaw)


def straight(view: Evidence) -> float:
    """Return the way from the start over the lamps to the last one's goal circle. [m]"""
    truth = view.truth
    way = np.array([(truth.x[0], truth.y[0]), *stops(view)])
    return float(np.hypot(*np.diff(way, axis=0).T).sum()) - radius(view)


def wrapped(angle: Array) -> Array:
    """Return angles in [-pi, pi). [rad]"""
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


def _way(view: Evidence, motion: Motion) -> tuple[Array, Array]:
    """Return the way to the lamp that is next, along x and y. [m, map]"""
    lamps = np.array(stops(view))
    if not len(lamps):
        unknown = np.full(len(motion.time), np.nan)
        return unknown, unknown
    there = lamps[turn(view, motion.time)]
    return there[:, 0] - motion.x, there[:, 1] - motion.y
