# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compiled vehicle dynamics: one vehicle, and each of many on a CPU or a GPU."""
