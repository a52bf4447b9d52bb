# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""lta light link: the inverse square by hand, the paper's figures, bad input in one sentence."""

import json
import math

import pytest


def test_the_link_by_distance(call, tmp_path):
    words = ('--scenario', 'lamp_room', '--distance', '3', '--distance', '7', '--blocks', '3')
    status, said = call('light', 'link', *words, '--out', str(tmp_path / 'out'), '--json')
    assert status == 0
    found = json.loads(said.out)
    near, far = found['links'][0]['at']
    # 10 klm from 1 m up, the ring 97 cm up: 3 cm under the axis hardly count.
    assert far['lux'] == pytest.approx(10_000.0 / math.pi / 49.0, rel=1e-3)
    assert near['lux'] == pytest.approx(10_000.0 / math.pi / 9.0, rel=1e-3)
    assert far['read'] > far['lux'] + 0.9 * far['echo']
    assert near['snr'] > far['snr'] > 10.0
    assert f'At 7 m the SNR is {far["snr"]:.0f} in lamp_room.' in said.err
    assert f'{near["lux"]:.1f}' in said.err
    assert (tmp_path / 'out' / 'report.html').is_file()
    assert json.loads((tmp_path / 'out' / 'link.json').read_text())['links'] == found['links']


def test_no_distance_inside_is_one_sentence(call, tmp_path):
    status, said = call('light', 'link', '--scenario', 'lamp_room', '--distance', '50')
    assert status == 2
    assert said.err.strip().startswith(
        'At all distances from the lamp, the drone would be outside'
    )
