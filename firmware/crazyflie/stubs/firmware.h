// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* As much of crazyflie-firmware as the app touches, for the host's compiler. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define T2M(ticks) (ticks)
#define APPCHANNEL_MTU 31
#define COMMANDER_PRIORITY_CRTP 1
#define PARAM_UINT8 0x08
#define PARAM_UINT32 0x0A
#define PARAM_RONLY 0x40
#define PARAM_GROUP_START(name)
#define PARAM_ADD(type, name, address) const void *lta_param_##name = address;
#define PARAM_GROUP_STOP(name)
#define taskENTER_CRITICAL()
#define taskEXIT_CRITICAL()

typedef enum { controlModeLegacy, controlModeForceTorque, controlModeForce } control_mode_t;
typedef struct {
  float normalizedForces[4];
  control_mode_t controlMode;
} control_t;
typedef struct {
  uint32_t timestamp;
} setpoint_t;
typedef struct {
  int unused;
} sensorData_t;
typedef struct {
  int unused;
} state_t;
typedef uint32_t stabilizerStep_t;

uint32_t xTaskGetTickCount(void);
size_t appchannelReceiveDataPacket(void *buffer, size_t most, int timeout_ms);
void commanderSetSetpoint(setpoint_t *setpoint, int priority);
void commanderRelaxPriority(void);
bool supervisorRequestArming(bool arm);
bool supervisorIsArmed(void);
void appMain(void);
void ltaAppStep(void);
void controllerOutOfTreeInit(void);
bool controllerOutOfTreeTest(void);
void controllerOutOfTree(control_t *control, const setpoint_t *setpoint,
                         const sensorData_t *sensors, const state_t *state,
                         const stabilizerStep_t step);
