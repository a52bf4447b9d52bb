# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Energy studies: power budget, hovering, solar cells, break-even light and panel mounts."""
