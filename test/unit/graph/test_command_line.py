# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Which parameters a node's command line gives to it."""

import pytest

command_line = pytest.importorskip('lta_graph.ros.command_line', exc_type=ImportError)


@pytest.mark.parametrize(
    ('words', 'names'),
    [
        ([], []),
        (['-p', 'frequency:=175.0'], ['frequency']),
        (['--param', 'prior.distance:=1.0', '-r', '__ns:=/a'], ['prior.distance']),
        (['-p', 'demodulator:window:=x', '-p', 'other:seed:=1'], ['window']),
        (['-p', '/**:window:=x'], ['window']),
        (['-p', "strategy:='a:=b'"], ['strategy']),
    ],
)
def test_the_parameters_given_to_a_node(words, names):
    line = ['program', '--ros-args', *words]
    assert command_line.list_parameter_names(line, 'demodulator') == names
