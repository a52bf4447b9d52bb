# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Tell commands from measurements: by the names of topics, and by values that are held."""

from typing import Final

from lta_data.importers.protocol import Numbers
from lta_data.interpretation.column_names import JOYSTICKS, match_role, parse_column_name
import numpy as np

DRIVES: Final = ('motors', 'wrench_command')  # topics that drive the rotors
HELD_SHARE: Final = 0.5  # share of repeated rows from which a place is a setpoint


def is_command_topic(topic: str) -> bool:
    """Return whether a topic, relative to the robot, holds commands or setpoints."""
    words = parse_column_name(topic).words
    # An absolute name is that of no robot
    named = topic in DRIVES or topic.startswith('/') or bool(words & JOYSTICKS)
    return named or match_role(words) == 'setpoint'


def is_held(rows: Numbers) -> bool:
    """Return whether rows, shape (n, k), are those of a setpoint: they change, mostly by steps."""
    repeated = float(np.mean((np.diff(rows, axis=0) == 0.0).all(axis=1)))
    return HELD_SHARE < repeated < 1.0
