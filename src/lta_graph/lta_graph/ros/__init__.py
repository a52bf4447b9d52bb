# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The modules that import rclpy, shared by all nodes."""

from lta_graph.interrupts import guard_start

guard_start(__name__)
