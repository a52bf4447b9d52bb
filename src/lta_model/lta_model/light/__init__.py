# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The light of a scene: lamps, what a room throws back, sky and mains, and who sees what."""
