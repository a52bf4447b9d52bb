# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The vehicle model: vehicle, effects, sensors and scene light, independent of the simulator."""
