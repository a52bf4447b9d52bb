# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a drone hears of a lamp: inverse square, shade and walls by hand, SNR as simulated."""

import math

from lta_model.light.field import PlaneIlluminance
from lta_model.sensors.photodiode_adc import PhotodiodeBoard
from lta_studies.light.plan.floor import build_floor, LampMount
from lta_studies.light.plan.planner import _explain_no_reception
from lta_studies.light.plan.rays import is_blocked
from lta_studies.light.plan.reception import (
    ambient_shares,
    build_lamp_link,
    build_light_field,
    compute_lamp_light,
    single_lamp_snr,
    solve_required_light,
)
from lta_vlc.demodulation import demodulate_beacon, plan_bins
import numpy as np
import pytest

from .halls import ear, hall, rectangle

ON_AXIS = 10000.0 / math.pi  # cd of 10 klm with the order 1
RING = 0.07  # m, of GT-MAB's diodes
RESPONSE = 1.2  # exponent of the cosine of its diodes
BETWEEN = math.cos(math.pi / 8) ** RESPONSE  # what two of eight read of a lamp between them


def light(plan, mount, faintest=0.0, cell=0.5):
    who = ear()
    floor = build_floor(plan, who.vehicle, cell)
    return floor, compute_lamp_light(plan, who, floor, [mount], faintest)[0]


def test_one_lamp_lights_by_the_inverse_square_at_the_heading_between_two_diodes():
    # The lamp on the west wall, as high as the diodes (2 m less 33 cm).
    lamp = LampMount((0.0, 6.25, 1.67), (1.0, 0.0, 0.0))
    floor, (least, most) = light(hall(), lamp)
    for (x, y), low, high in zip(floor.cell_centers, least, most, strict=True):
        off = math.hypot(x, y - 6.25)
        straight = ON_AXIS * (x / off) / off**2
        # Two of eight diodes are 22.5 degrees off at worst; headings 5.6 degrees apart may
        # miss 2.8 (2.5 % of the reading); and they stand up to 7 cm nearer.
        near = 2.5 * RING / off
        assert low == pytest.approx(straight * BETWEEN, rel=0.025 + near)
        assert high == pytest.approx(straight, rel=near)


def test_it_is_heard_as_far_as_the_light_it_takes():
    plan = hall(outline=rectangle(0, 0, 120, 6))
    lamp = LampMount((0.0, 3.25, 1.67), (1.0, 0.0, 0.0))
    who = ear()
    share = ambient_shares(plan, who).mean()
    needed = solve_required_light(build_lamp_link(plan, who, lamp, 150.0), share, who.required_snr)
    floor, (least, _) = light(plan, lamp)
    on_axis = floor.cell_centers[:, 1] == 3.25
    heard = floor.cell_centers[on_axis & (least >= needed), 0]
    reach = math.sqrt(ON_AXIS * BETWEEN / needed)
    assert 20.0 < reach < 119.0
    assert heard.max() == pytest.approx(reach, abs=0.5)


def test_the_light_needed_by_hand():
    # 5.2 mm2 x 0.374 A/W x 100 kohm x 4096 / 3.3 V, by 300 lm/W: 0.8046 counts/lx. The
    # fundamental of the wave is 2/pi of that. White noise of variance s2 has a mean magnitude of
    # s sqrt(pi / 1000): 300 uV/sqrt(10), shot noise, a converter's of 1 step, 1/12 for rounding.
    counts = 5.2e-6 * 0.373978 * 1e5 / 300.0 * 4096 / 3.3
    # Ambient light from all sides, of which the hull hides most of what comes from above.
    who, plan = ear(), hall()
    share = ambient_shares(plan, who).mean()
    assert 0.5 < share < 2.0 / (RESPONSE + 1.0)
    steady = 100.0 * share
    shot = 2.0 * 1.602e-19 * (math.pi / 2 * 14e3) * 1e5 * (steady * counts) * 4096 / 3.3
    variance = (300e-6 * 4096 / 3.3) ** 2 / 10.0 + 1.0 / 12.0 + 1.0 + shot
    by_hand = 12.0 * math.sqrt(math.pi * variance / 1000.0) / (2.0 / math.pi * counts)
    heard = build_lamp_link(plan, who, LampMount((0, 6, 1.67), (1, 0, 0)), 150.0)
    found = solve_required_light(heard, share, who.required_snr)
    # Of the lamp's harmonics those above Nyquist fold into the bins of the noise: 2 %.
    assert found == pytest.approx(1.02 * by_hand, rel=0.01)


def test_light_that_fills_the_converter_leaves_nothing_to_hear():
    plan, who = hall(), ear()
    heard = build_lamp_link(plan, who, LampMount((0.0, 6.0, 1.67), (1.0, 0.0, 0.0)), 150.0)
    assert solve_required_light(heard._replace(steady=4000.0), 1.0, who.required_snr) < math.inf
    assert solve_required_light(heard._replace(steady=4100.0), 1.0, who.required_snr) == math.inf
    assert 'the ambient light of 100 lx saturates its ADC' in _explain_no_reception(
        plan, who, math.inf
    )


def test_the_snr_is_that_of_blocks_that_are_made_and_demodulated():
    who, lamp = ear(), LampMount((0.0, 6.0, 1.67), (1.0, 0.0, 0.0))
    plan = hall(ambient={'steady': '300 lx', 'mains_amplitude': '40 lx',
                         'mains_frequency': '100 Hz', 'efficacy': '300 lm/W'})  # fmt: skip
    settings = who.demodulation.model_copy(update={'frequency': 530.0})
    bins = plan_bins(settings, 1e4, 1000)
    for lux in (2.0, 20.0, 200.0):
        share = ambient_shares(plan, who).mean()
        ambient = (np.full((1, 8), part * share) for part in (300.0, 40.0))
        given = PlaneIlluminance(np.full((1, 1, 8), lux), *ambient)
        chance = np.random.default_rng(1)
        snrs, state = [], None
        board = PhotodiodeBoard(
            who.vehicle.diodes, build_light_field(plan, lamp, 530.0), 1e4, 1000
        )
        for k in range(20):
            block, state = board.sample_block(given, k * 100_000_000, chance, state)
            snrs.append(demodulate_beacon(block, bins).snr)
        expected = single_lamp_snr(build_lamp_link(plan, who, lamp, 530.0), share, lux)
        # Noise and what waves leave in its bins add as squares do: their sum is on the safe side.
        assert expected <= np.mean(snrs) <= 1.08 * expected


def test_a_lamp_overhead_is_in_the_shade_of_the_hull():
    lamp = LampMount((6.0, 6.0, 3.5), (0.0, 0.0, -1.0))
    floor, (least, most) = light(hall(), lamp, cell=0.25)
    off = np.hypot(*(floor.cell_centers - 6.0).T)
    rise = 3.5 - 1.67
    # By the tangent from a diode at 7 cm and 33 cm below to the hull of 50 by 29.95 cm.
    a, c, x, z = 0.5, 0.2995, 0.07, -0.33
    slopes = np.linspace(0.0, 2.0, 20001)
    u, w, p, q = 1.0 / a, slopes / c, x / a, z / c
    clear = (p * u + q * w) ** 2 < (p * p + q * q - 1.0) * (u * u + w * w)
    steepest = slopes[clear].max()
    shade = rise / steepest
    assert 4.0 < shade < 5.0
    assert np.all(most[off < shade - 0.2] == 0.0)
    corners = off > shade + 0.2
    assert corners.any()
    assert np.all(most[corners] > 0.0)
    assert np.all(least <= most)


def test_walls_and_racks_stop_light_where_they_are_high_enough():
    rack = np.array([[2.0, -1.0, 2.0, 1.0, 3.0]])
    assert is_blocked((0.0, 0.0, 1.0), (4.0, 0.0, 4.9), rack)  # 2.95 m over the rack's place
    assert not is_blocked((0.0, 0.0, 1.0), (4.0, 0.0, 5.1), rack)
    assert not is_blocked((0.0, 0.0, 1.0), (1.9, 0.0, 1.0), rack)
    assert not is_blocked((0.0, 0.0, 1.0), (4.0, 2.1, 1.0), rack)  # passes beside it


def test_behind_a_rack_there_is_no_light():
    rack = rectangle(5, 4, 6, 9) | {'height': '3 m'}
    lamp = LampMount((0.05, 6.5, 1.67), (1.0, 0.0, 0.0))
    floor, (least, _) = light(hall(obstacles={'rack': rack}), lamp)
    x, y = floor.cell_centers.T
    # The shadow widens from the rack's near edge: 2.5 m to either side at 4.95 m.
    shadow = (x > 6.0) & (np.abs(y - 6.5) < 2.5 / 4.95 * (x - 0.05) - 0.1)
    lit = (x > 6.0) & (np.abs(y - 6.5) > 2.5 / 4.95 * (x - 0.05) + 0.1)
    assert shadow.sum() > 20
    assert np.all(least[shadow] == 0.0)
    assert np.all(least[lit] > 0.0)
