# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Figures derived from a vehicle file: mass, balance, thrust, speed, stability and helium."""
