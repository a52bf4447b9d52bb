# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Messages with random content, serialised without ROS."""

from lta_bag.schemas import load_jazzy_types
from lta_config.topics import load_topic_table
import numpy as np
import pytest

# Those of topics.yaml, and some that others publish
GRAPH_TYPES = [
    *sorted({row.type for row in load_topic_table().topics.values()}),
    'rcl_interfaces/msg/Log',
    'sensor_msgs/msg/Image',
    'sensor_msgs/msg/JointState',
    'sensor_msgs/msg/PointCloud2',
    'std_msgs/msg/Int16MultiArray',
]
OCTETS = {'byte': 'uint8', 'char': 'uint8', 'octet': 'uint8'}
WIDTHS = (8, 16, 32, 64)
INTEGERS = {f'{sign}int{bits}' for sign in ('', 'u') for bits in WIDTHS}


def random_base(name, rng):
    if name == 'string':
        return ''.join(rng.choice(list('abc/ _\u00e9\u0414'), rng.integers(0, 12)))
    if name == 'bool':
        return bool(rng.integers(2))
    if name in OCTETS:
        return int(rng.integers(128))  # rosbags packs a lone byte as signed.
    if name in INTEGERS:
        info = np.iinfo(name)
        return int(rng.integers(info.min, info.max, dtype=info.dtype, endpoint=True))
    return float(np.dtype(name).type(rng.normal()))


def random_value(desc, rng):
    """Return a random value for one field; see rosbags' field descriptions."""
    kind, what = int(desc[0]), desc[1]
    if kind == 1:
        return random_base(what[0], rng)
    if kind == 2:
        return random_instance(what, rng)
    inner, length = what
    count = length if kind == 3 else int(rng.integers(1, 5))
    values = [random_value(inner, rng) for _ in range(count)]
    if int(inner[0]) == 2 or inner[1][0] == 'string':
        return values
    return np.array(values, dtype=OCTETS.get(inner[1][0], inner[1][0]))


def random_instance(type_name, rng):
    described = load_jazzy_types().fielddefs[type_name][1]
    values = {name: random_value(field, rng) for name, field in described}
    return load_jazzy_types().types[type_name](**values)


@pytest.fixture(params=GRAPH_TYPES)
def graph_type(request):
    return request.param


@pytest.fixture
def random_message():
    """Return a function from type name and generator to a message and its bytes."""

    def make(type_name, rng):
        message = random_instance(type_name, rng)
        return message, bytes(load_jazzy_types().serialize_cdr(message, type_name))

    return make
