# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The link to the light board: MAVLink 2 bytes in, blocks of the photodiodes in ROS time out."""
