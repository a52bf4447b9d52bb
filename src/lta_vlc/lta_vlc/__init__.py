# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Demodulate modulated light (VLC) and estimate the bearing and position of a lamp."""
