# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Descriptions of a drone and its scene for viewers: URDF, fixed frames, markers."""
