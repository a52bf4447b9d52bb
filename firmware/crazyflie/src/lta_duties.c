// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
#include "lta_duties.h"

#define SIZE (2 + 2 * LTA_MOTORS + 2)

static uint16_t u16(const uint8_t *data) { return (uint16_t)(data[0] | data[1] << 8); }

bool lta_duties_hold(const lta_duties_t *duties, uint32_t now_ms) {
  /* Unsigned difference: right across the wrap of the tick after 49.7 days. */
  return now_ms - duties->since_ms < duties->hold_ms;
}

uint32_t lta_duties_silence(const lta_duties_t *duties, uint32_t now_ms) {
  const uint32_t age = now_ms - duties->since_ms;
  return age < duties->hold_ms ? 0 : age - duties->hold_ms;
}

bool lta_duties_take(lta_duties_t *duties, const uint8_t *data, size_t size, uint32_t now_ms) {
  if (size != SIZE || data[0] != LTA_MARK) {
    return false;
  }
  const uint8_t ahead = (uint8_t)(data[1] - duties->sequence);
  const bool ordered = duties->known && lta_duties_silence(duties, now_ms) < LTA_FORGET_MS;
  if (ordered && (ahead == 0 || ahead >= 128)) {
    return false; /* doubled, or overtaken on the way */
  }
  for (int motor = 0; motor < LTA_MOTORS; motor++) {
    const float duty = (float)(int16_t)u16(data + 2 + 2 * motor) / LTA_FULL;
    duties->duty[motor] = duty < 0.0f ? 0.0f : duty > 1.0f ? 1.0f : duty;
    duties->turned |= duty > 0.0f;
  }
  duties->sequence = data[1];
  duties->since_ms = now_ms;
  const uint32_t asked_ms = u16(data + 2 + 2 * LTA_MOTORS);
  duties->hold_ms = asked_ms < LTA_MOST_HOLD_MS ? asked_ms : LTA_MOST_HOLD_MS;
  duties->known = true;
  return true;
}

void lta_duties_now(const lta_duties_t *duties, uint32_t now_ms, float out[LTA_MOTORS]) {
  const bool holds = lta_duties_hold(duties, now_ms);
  for (int motor = 0; motor < LTA_MOTORS; motor++) {
    out[motor] = holds ? duties->duty[motor] : 0.0f;
  }
  if (holds && duties->turned && out[0] < LTA_KEEP_FLYING) {
    out[0] = LTA_KEEP_FLYING;
  }
}

void lta_duties_forget(lta_duties_t *duties) { duties->turned = false; }
