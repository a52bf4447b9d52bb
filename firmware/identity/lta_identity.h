// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* What a build is: the commit of its sources, and the vehicle that it was built for.
 *
 * `make firmware` sets both and reads them back from the image; the bridge compares the vehicle
 * with its own file whenever a board connects. 0 is unknown. */
#pragma once

#include <stdint.h>

#ifndef LTA_COMMIT
#define LTA_COMMIT 0 /* first eight digits of the commit */
#endif
#ifndef LTA_VEHICLE
#define LTA_VEHICLE 0 /* lta_config/vehicle_identity.py */
#endif

typedef struct {
  char mark[4]; /* to find it in an image */
  uint32_t commit;
  uint32_t vehicle;
} lta_identity_t;

#define LTA_IDENTITY {{'L', 'T', 'A', 'i'}, LTA_COMMIT, LTA_VEHICLE}
