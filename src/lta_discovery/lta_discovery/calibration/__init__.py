# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Calibrate a vehicle from its flights: what every vehicle file must state."""
