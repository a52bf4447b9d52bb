# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
How far the drone's idea of its airspeed is from the truth, by how fast it flies.

Fly once, then in the environment of LTA:

    ./lta simulate --seed 3 --out flight
    (root=$PWD; . tools/workspace.sh; .venv/bin/python examples/analyse_a_bag.py flight/bag)
"""

import sys

import lta_analysis

flight = lta_analysis.open(sys.argv[1])
frame = flight.align_topics('airspeed', 'ground_truth/odom', rate=50.0, method='linear')
unit = frame.attrs['units']['airspeed/twist.twist.linear.x']
truth = frame['ground_truth/odom/twist.twist.linear.x']
frame['error'] = frame['airspeed/twist.twist.linear.x'] - truth
table = frame.groupby(truth.round(1).rename('speed') + 0.0)['error']
print(f'Estimated less true airspeed [{unit}]')
print(table.agg(['count', 'mean', 'std', 'min', 'max']).round(4).to_string())
