# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Wind limits of each platform: in uniform wind, and over rough ground."""
