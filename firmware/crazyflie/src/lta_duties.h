// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* Duties from the ground and for how long they hold; plain C, no firmware headers. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define LTA_MOTORS 4
#define LTA_MARK 0x4C
#define LTA_FULL 32767
#define LTA_MOST_HOLD_MS 500 /* whatever a packet asks for: no motor turns on for longer */
#define LTA_FORGET_MS 1000   /* without packets, after which any sequence number may come */
/* One step of 65535, and a half so that no rounding loses it: below the 8 bits of the PWM. */
#define LTA_KEEP_FLYING (1.5f / 65535.0f)

typedef struct {
  float duty[LTA_MOTORS]; /* 0 to 1; these rotors do not reverse */
  uint32_t since_ms;      /* when the newest packet came */
  uint32_t hold_ms;       /* for how long it holds; 0: nothing holds */
  uint8_t sequence;
  bool known;  /* whether any packet has come */
  bool turned; /* whether a motor was commanded to turn since lta_duties_forget */
} lta_duties_t;

/* Take a packet, `<BB4hH`: mark, sequence, duties in 1/32767, time-out in ms, LTA_MOST_HOLD_MS at
 * most. Returns whether it counts: of the right size and mark, and newer than the last one. After a
 * hand-over, whose time-out is 0, a packet that was overtaken must not start the motors again: so
 * the order counts until no packet has held for LTA_FORGET_MS. */
bool lta_duties_take(lta_duties_t *duties, const uint8_t *data, size_t size, uint32_t now_ms);

/* Tell whether the newest packet still holds. */
bool lta_duties_hold(const lta_duties_t *duties, uint32_t now_ms);

/* Return for how long no packet has held; 0 while one does. [ms] */
uint32_t lta_duties_silence(const lta_duties_t *duties, uint32_t now_ms);

/* Write what the motors shall do: the duties while they hold, nothing otherwise.
 *
 * The supervisor takes a drone whose motors stand for 2 s as landed, and disarms it 3 s later. A
 * blimp coasts for longer. So once it has flown, the first motor keeps LTA_KEEP_FLYING while
 * packets hold: that counts as flying and leaves the pin low. */
void lta_duties_now(const lta_duties_t *duties, uint32_t now_ms, float out[LTA_MOTORS]);

/* Forget that a motor turned: the flight is over, or has not begun. */
void lta_duties_forget(lta_duties_t *duties);
