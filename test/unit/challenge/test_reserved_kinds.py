"""Kinds that no challenge draws push as a hand reckons."""

import math

from lta_model.effects.protocol import VehicleMotion
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from .test_outside_kinds import changed, moving, pushed

TURNED = Rotation.from_euler('zyx', [0.3, 0.2, -0.1])
NORTH = Rotation.from_euler('z', 0.5 * math.pi)


def test_gas_warms_after_a_climb() -> None:
    # m g G / T of 0.413 kg of displaced air and 1 K/m at 293 K.
    size = 0.413 * 9.81 / 293.0
    assert size == pytest.approx(0.0138, rel=0.01)
    given = {'size': size, 'lag': 20.0}
    heavy = pushed('thermal_lag', moving((0.0, 0.0, 2.0), TURNED), (1.5,), **given)
    assert TURNED.apply(heavy[:3]) == pytest.approx([0.0, 0.0, -0.5 * size])
    warm = changed('thermal_lag', lambda _: moving((0.0, 0.0, 2.5)), 20.01, (1.5,), **given)
    assert warm[2000, 0] == pytest.approx(2.5 - math.exp(-1.0), abs=1e-3)


def test_a_nose_dents_forwards_and_above_its_onset() -> None:
    given = {'size': 0.1, 'onset': 0.3}
    for speed, drag in ((-0.5, 0.0), (0.0, 0.0), (0.3, 0.0), (0.5, 0.1 * (0.25 - 0.09))):
        wrench = pushed('dented_nose', moving(velocity=(speed, 0.4, 0.0)), **given)
        assert wrench == pytest.approx([-drag, 0.0, 0.0, 0.0, 0.0, 0.0], abs=1e-15)


def test_a_fin_lifts_and_then_stalls() -> None:
    given = {'size': 0.01, 'stall': 0.4}
    # Attached; half stalled, 0.5 (1.6 b + 2 sin^2 b); a flat plate
    half = 0.5 * (0.64 + 2.0 * math.sin(0.4) ** 2)
    for angle, slope in ((0.1, 0.16), (-0.1, -0.16), (0.4, half), (0.5 * math.pi, 2.0)):
        motion = moving(velocity=(2.0 * math.cos(angle), 2.0 * math.sin(angle), 0.1))
        force = -0.01 * 4.0 * slope
        expected = (0.0, force, 0.0, 0.0, 0.0, -0.4 * force)
        assert pushed('fin_stall', motion, **given) == pytest.approx(expected, rel=0.01)
    # At 1 rad/s to the left, the fin moves to the right at 0.4 m/s, and brakes
    braked = pushed('fin_stall', moving(rates=(0.0, 0.0, 1.0)), **given)
    assert braked[5] == pytest.approx(-0.4 * 0.01 * 0.16 * 2.0)
    # No flow, no force
    assert not pushed('fin_stall', moving(), **given).any()


def test_air_sinks_below_a_fan_and_turns_around_it() -> None:
    fan = {'size': 0.01, 'core': 0.3, 'east': 1.0, 'north': -1.0}
    below = pushed('ceiling_fans', moving((1.0, -1.0, 1.0)), **fan)
    assert below == pytest.approx([0.0, 0.0, -0.01, 0.0, 0.0, 0.0], abs=1e-15)
    assert pushed('ceiling_fans', moving((6.0, 4.0, 1.0)), **fan) == pytest.approx(below)
    # Fastest at the core radius, to the north in the east; the grid takes some percent off
    beside = pushed('ceiling_fans', moving((1.3, -1.0, 1.0)), **fan)
    assert beside[0] == pytest.approx(0.0, abs=1e-15)
    assert beside[1] == pytest.approx(0.01, rel=0.03)
    assert beside[2] == pytest.approx(-0.01 * math.exp(-1.0), rel=0.03)
    farther = pushed('ceiling_fans', moving((1.0, -0.4, 1.0), NORTH), **fan)
    # 2 c d / (c^2 + d^2) = 0.8 at twice the radius, to the west, which is on the left of a nose to
    # the north
    assert farther[:2] == pytest.approx([0.0, 0.008], rel=0.06, abs=1e-12)


def test_a_valve_vents_above_its_height_for_good() -> None:
    given = {'size': 0.02, 'opens': 2.0, 'empties': 10.0}

    def climbing(t: float) -> VehicleMotion:
        return moving((0.0, 0.0, 1.9 if t < 5.0 or t > 25.0 else 2.5))

    lost = changed('relief_valve', climbing, 40.0, (0.0,), **given)[:, 0]
    assert not lost[:499].any()
    # 20 s at 0.5 m above it: 1 - exp(-20 0.5 / 10)
    assert lost[2510:] == pytest.approx(np.full(1490, 1.0 - math.exp(-1.0)), abs=1e-3)
    wrench = pushed('relief_valve', moving(turn=TURNED), (0.5,), **given)
    assert TURNED.apply(wrench[:3]) == pytest.approx([0.0, 0.0, -0.01])


def test_stirred_air_keeps_its_direction() -> None:
    given = {'size': 0.04, 'settles': 10.0}
    order = (0.9, 0.9, 0.6, 0.2, 0.0, 0.0, 0.0, 0.0)
    air = changed(
        'stirred_air', lambda _: moving(turn=NORTH, command=order), 10.01, (0.0, 0.0), **given
    )
    # (0.36 + 0.04) / 2, to the north
    expected = [0.0, 0.2 * (1.0 - math.exp(-1.0))]
    assert air[1000] == pytest.approx(expected, abs=1e-4)
    assert pushed('stirred_air', moving(turn=NORTH), (0.0, 0.2), **given)[:3] == pytest.approx(
        [-0.008, 0.0, 0.0]
    )
    assert pushed('stirred_air', moving(), (0.0, 0.2), **given)[:3] == pytest.approx(
        [0.0, -0.008, 0.0]
    )
