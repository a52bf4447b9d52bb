# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Teleoperation by gamepad, keyboard or Joy messages, with instant take-over."""
