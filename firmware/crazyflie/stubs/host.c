// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* The firmware around the app, as a test drives it: a clock, one packet at a time, what was said. */
#include <string.h>

#include "firmware.h"

uint32_t host_now_ms;
uint8_t host_packet[APPCHANNEL_MTU];
size_t host_size;
int host_setpoints, host_relaxed, host_disarmed, host_armed = 1;

uint32_t xTaskGetTickCount(void) { return host_now_ms; }

size_t appchannelReceiveDataPacket(void *buffer, size_t most, int timeout_ms) {
  const size_t size = host_size < most ? host_size : most;
  memcpy(buffer, host_packet, size);
  host_now_ms += size ? 0 : (uint32_t)timeout_ms;
  host_size = 0;
  return size;
}

void commanderSetSetpoint(setpoint_t *setpoint, int priority) {
  (void)setpoint, (void)priority;
  host_setpoints++;
}

void commanderRelaxPriority(void) { host_relaxed++; }

bool supervisorRequestArming(bool arm) {
  host_disarmed += !arm;
  host_armed = arm;
  return true;
}

bool supervisorIsArmed(void) { return host_armed; }
