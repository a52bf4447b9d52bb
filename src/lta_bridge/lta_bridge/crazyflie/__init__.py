# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The bridge to a Crazyflie: telemetry, commands and the safety state machine.

Only `cflib_link` imports cflib, and only `messages` imports ROS. `links` selects the link by the
scheme of the URI.
"""
