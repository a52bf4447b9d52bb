# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Emulated hardware: a Crazyflie and a light board that fly in the simulated world."""

from lta_graph.interrupts import guard_start

guard_start(__name__)
