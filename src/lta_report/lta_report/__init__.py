# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Shared parts of all results: pages, figures, folders, progress bars and worker processes."""
