# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Power values printed in the seed paper."""

from typing import Final

IDLE: Final = 0.097  # W, stand-by: the controller estimates its state, motors off
TRANSMITTING: Final = 0.120  # W, stand-by and radio
HOVER: Final = 1.333  # W, stabilisation while hovering
NAVIGATION: Final = (1.523, 1.544)  # W, range over BAG, DES and DGA
STANDARD_SHARE: Final = 1.0 / 3.0  # of a standard drone: "almost one third"
STANDARD: Final = HOVER / STANDARD_SHARE  # W, implied hover power of a standard drone
HOVER_TIME: Final = 450.0  # s, on identical batteries
