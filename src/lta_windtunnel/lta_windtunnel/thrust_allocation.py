# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute the columns of B from flows with running rotors, and the coupling of their jets.

A column is the net wrench per newton of a rotor's full thrust. If the wrench of all rotors
together is not the sum of their columns, the rest is a coupling, per newton of the weakest rotor.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final

from lta_windtunnel.sweep_table import Blow, RotorPlacement, TunnelSweep
from lta_windtunnel.tunnel_model import RotorDisk
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
REVERSED_SUFFIX: Final = '_reversed'
ALL_ROTORS: Final = 'all'
MIN_COUPLING: Final = 0.10  # of one rotor's thrust: below this the columns superpose


@final
@dataclass(frozen=True, slots=True)
class AllocationColumn:
    """A wrench per newton about the hull centre [1, m], and its origin."""

    wrench: Array
    source: str


@final
@dataclass(frozen=True, slots=True)
class JetCoupling:
    """The additional wrench when the jets of some rotors interact, per newton of each. [1, m]."""

    rotors: tuple[str, ...]
    wrench: Array


def symmetrize_wrench(sweep: TunnelSweep, blow: Blow) -> Array:
    """
    Return force and moment of a pattern, averaged over its symmetries. [N, N m].

    Components that must vanish by symmetry become zero instead of mesh noise, which no pair of
    rotors could cancel.
    """
    wrench = np.array([*blow.force, *blow.moment])
    own = [
        np.array(rows)
        for rows in sweep.symmetries
        if _is_pattern_symmetry(sweep, blow.shares, rows)
    ]
    mean: Array = np.mean([transform_wrench(wrench, each) for each in own or [np.eye(3)]], axis=0)
    return mean


def _is_pattern_symmetry(
    sweep: TunnelSweep, shares: Mapping[str, float], rows: Sequence[list[float]]
) -> bool:
    """Return whether a symmetry of the bodies maps each running rotor to an equal one."""
    change = np.array(rows)
    return all(
        any(
            # Both rotors must also run at the same share
            shares[other] == share and maps_onto(change, sweep.rotors[name], sweep.rotors[other])
            for other in shares
        )
        for name, share in shares.items()
    )


def maps_onto(
    change: Array, one: RotorPlacement | RotorDisk, other: RotorPlacement | RotorDisk
) -> bool:
    """Return whether a symmetry of the bodies maps one rotor to another."""
    # [m] and [1]; far below the tolerance of a drawing
    place = np.allclose(change @ one.place, other.place, atol=1e-6)
    return place and np.allclose(change @ one.axis, other.axis, atol=1e-6)


def find_symmetric_rotors(sweep: TunnelSweep, name: str) -> list[tuple[str, Array]]:
    """Return the rotors that a symmetry of the bodies maps to this one, with that symmetry."""
    one, twins = sweep.rotors[name], []
    for rows in sweep.symmetries:
        change = np.array(rows)
        for other, rotor in sweep.rotors.items():
            if other != name and maps_onto(change, rotor, one):
                twins.append((other, change))
    return twins


def transform_wrench(wrench: Array, change: Array) -> Array:
    """Rotate or reflect a wrench; a reflection also reverses the moment."""
    # A moment is a pseudovector; the determinant of a reflection is -1
    moment = np.linalg.det(change) * (change @ wrench[3:])
    return np.concatenate((change @ wrench[:3], moment))


def find_rotor_column(
    sweep: TunnelSweep, name: str, backward: bool = False
) -> AllocationColumn | None:
    """
    Return the column of a rotor or of its symmetric twin; None if neither was solved.

    A backward column is for negative thrust: minus the wrench, per newton.
    """
    sign, word = (-1.0, REVERSED_SUFFIX) if backward else (1.0, '')
    if (blow := sweep.blows.get(name + word)) is not None:
        return AllocationColumn(
            sign * symmetrize_wrench(sweep, blow) / sweep.rotors[name].thrust, 'rotor on'
        )
    for twin, change in find_symmetric_rotors(sweep, name):
        if (blow := sweep.blows.get(twin + word)) is not None:
            wrench = (
                sign
                * transform_wrench(symmetrize_wrench(sweep, blow), change)
                / sweep.rotors[twin].thrust
            )
            return AllocationColumn(wrench, f'as {twin}, by symmetry')
    return None


def sum_columns(sweep: TunnelSweep, shares: Mapping[str, float]) -> Array | None:
    """Return the sum of a pattern's columns, or None if one is missing [N, N m]."""
    total = np.zeros(6)
    for name, share in shares.items():
        column = find_rotor_column(sweep, name, share < 0.0)
        if column is None:
            return None
        total += share * sweep.rotors[name].thrust * column.wrench
    return total


def compute_jet_coupling(sweep: TunnelSweep) -> JetCoupling | None:
    """Return the wrench of all rotors beyond their columns, unless negligible."""
    blow = sweep.blows.get(ALL_ROTORS)
    if blow is None or (sum_ := sum_columns(sweep, blow.shares)) is None:
        return None
    weakest = min(sweep.rotors[name].thrust for name in blow.shares)
    rest = (symmetrize_wrench(sweep, blow) - sum_) / weakest
    if np.linalg.norm(rest[:3]) <= MIN_COUPLING:
        return None
    return JetCoupling(tuple(blow.shares), rest)


def linearity_ratio(sweep: TunnelSweep, pattern: str) -> float | None:
    """
    Return the wrench at part thrust over its share of that at full thrust [1].

    1 where the wrench is linear in thrust; None if `<pattern>_quarter` was not solved.
    """
    full, part = sweep.blows.get(pattern), sweep.blows.get(f'{pattern}_quarter')
    if full is None or part is None:
        return None
    share = next(iter(part.shares.values())) / next(iter(full.shares.values()))
    # The largest component is the least affected by mesh noise
    most = int(np.argmax(np.abs(full.force)))
    return part.force[most] / (share * full.force[most])
