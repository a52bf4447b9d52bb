# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Simulation of the world: vehicle, physical effects, light field and sensors."""
