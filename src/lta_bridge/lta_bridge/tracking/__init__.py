# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Pose and motion of the drone from an external tracker."""
