# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Gains in round numbers, for calculations by hand; no vehicle's."""

from lta_control.laws.cascade import CascadeGains, PidGains

GAINS = CascadeGains(
    altitude_kp=0.6,
    climb_limit=0.15,
    climb=PidGains(kp=0.5, ki=0.15, kd=0.0, limit=0.2),
    heading_kp=0.6,
    yaw_rate_limit=0.3,
    yaw_rate=PidGains(kp=0.04, ki=0.01, kd=0.0, limit=0.006),
    speed=PidGains(kp=0.15, ki=0.03, kd=0.0, limit=0.05),
    turn_first=0.6,
    drift_gain=1.5,
    drift_limit=0.7,
    speed_limit=1.0,
    rise_limit=0.5,
    swing_gain=0.2,
)
