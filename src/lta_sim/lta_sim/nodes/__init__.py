# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""ROS nodes of lta_sim."""

from lta_graph.interrupts import guard_start

guard_start(__name__)
