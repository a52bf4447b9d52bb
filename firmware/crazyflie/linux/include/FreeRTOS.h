// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* The part of FreeRTOS's interface that the firmware uses, on POSIX threads (rtos.c).
 *
 * A tick is a millisecond of CLOCK_MONOTONIC. Every task is a thread, and one runs at a time until
 * it waits: no task interrupts another, whatever its priority.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef long BaseType_t;
typedef unsigned long UBaseType_t;
typedef uint32_t TickType_t;
typedef uint8_t StackType_t;
typedef struct rtos_queue *QueueHandle_t;
typedef struct rtos_queue *SemaphoreHandle_t;
typedef struct rtos_timer *TimerHandle_t;
typedef void *TaskHandle_t;
typedef void (*TaskFunction_t)(void *);
typedef void (*TimerCallbackFunction_t)(TimerHandle_t);
typedef struct {
  int unused;
} StaticTask_t, StaticQueue_t, StaticSemaphore_t, StaticTimer_t;

/* The names before version 8, which the firmware still uses. */
typedef QueueHandle_t xQueueHandle;
typedef SemaphoreHandle_t xSemaphoreHandle;
typedef TaskHandle_t xTaskHandle;
typedef TimerHandle_t xTimerHandle;
typedef TickType_t portTickType;
#define portBASE_TYPE long

#define pdTRUE ((BaseType_t)1)
#define pdFALSE ((BaseType_t)0)
#define pdPASS pdTRUE
#define pdFAIL pdFALSE
#define errQUEUE_FULL ((BaseType_t)0)
#define portMAX_DELAY ((TickType_t)0xffffffffUL)
#define portTICK_RATE_MS ((TickType_t)1)
#define portTICK_PERIOD_MS ((TickType_t)1)
#define portYIELD()
#define portYIELD_FROM_ISR(woken) ((void)(woken))
#define portDISABLE_INTERRUPTS()
#define portENABLE_INTERRUPTS()
#define portSET_INTERRUPT_MASK_FROM_ISR() 0
#define portCLEAR_INTERRUPT_MASK_FROM_ISR(mask) ((void)(mask))
#define tskIDLE_PRIORITY 0
#define taskENTER_CRITICAL()
#define taskEXIT_CRITICAL()
#define portENTER_CRITICAL()
#define portEXIT_CRITICAL()

#include "FreeRTOSConfig.h"

/* Tasks. */
TaskHandle_t xTaskCreateStatic(TaskFunction_t function, const char *name, uint32_t depth,
                               void *argument, UBaseType_t priority, StackType_t *stack,
                               StaticTask_t *task);
BaseType_t xTaskCreate(TaskFunction_t function, const char *name, uint32_t depth, void *argument,
                       UBaseType_t priority, TaskHandle_t *handle);
TickType_t xTaskGetTickCount(void);
#define xTaskGetTickCountFromISR xTaskGetTickCount
void vTaskDelay(TickType_t ticks);
void vTaskDelayUntil(TickType_t *last, TickType_t ticks);
#define vTaskSetApplicationTaskTag(task, tag) ((void)(tag))
#define vTaskSuspendAll()
#define xTaskResumeAll() pdTRUE

/* Queues; a semaphore is a queue of empty items, a mutex one that begins full. */
QueueHandle_t xQueueCreate(UBaseType_t length, UBaseType_t size);
#define xQueueCreateStatic(length, size, storage, queue) \
  ((void)(storage), (void)(queue), xQueueCreate((length), (size)))
BaseType_t xQueueSend(QueueHandle_t queue, const void *item, TickType_t ticks);
BaseType_t xQueueReceive(QueueHandle_t queue, void *item, TickType_t ticks);
BaseType_t xQueuePeek(QueueHandle_t queue, void *item, TickType_t ticks);
BaseType_t xQueueOverwrite(QueueHandle_t queue, const void *item);
BaseType_t xQueueReset(QueueHandle_t queue);
UBaseType_t uxQueueMessagesWaiting(QueueHandle_t queue);
#define xQueueSendToBack xQueueSend
#define xQueueSendFromISR(queue, item, woken) ((void)(woken), xQueueSend((queue), (item), 0))
#define xQueueOverwriteFromISR(queue, item, woken) ((void)(woken), xQueueOverwrite(queue, item))
SemaphoreHandle_t xSemaphoreCreateBinary(void);
SemaphoreHandle_t xSemaphoreCreateMutex(void);
#define xSemaphoreCreateBinaryStatic(storage) ((void)(storage), xSemaphoreCreateBinary())
#define xSemaphoreCreateMutexStatic(storage) ((void)(storage), xSemaphoreCreateMutex())
#define vSemaphoreCreateBinary(semaphore) ((semaphore) = xSemaphoreCreateMutex())
#define xSemaphoreTake(semaphore, ticks) xQueueReceive((semaphore), NULL, (ticks))
#define xSemaphoreGive(semaphore) xQueueSend((semaphore), NULL, 0)
#define xSemaphoreGiveFromISR(semaphore, woken) ((void)(woken), xSemaphoreGive(semaphore))
#define xSemaphoreTakeFromISR(semaphore, woken) ((void)(woken), xSemaphoreTake((semaphore), 0))

/* Timers, each a thread. */
TimerHandle_t xTimerCreate(const char *name, TickType_t period, UBaseType_t repeats, void *id,
                           TimerCallbackFunction_t callback);
#define xTimerCreateStatic(name, period, repeats, id, callback, storage) \
  ((void)(storage), xTimerCreate((name), (period), (repeats), (id), (callback)))
BaseType_t xTimerChangePeriod(TimerHandle_t timer, TickType_t period, TickType_t ticks);
BaseType_t xTimerStart(TimerHandle_t timer, TickType_t ticks);
BaseType_t xTimerStop(TimerHandle_t timer, TickType_t ticks);
BaseType_t xTimerDelete(TimerHandle_t timer, TickType_t ticks);
void *pvTimerGetTimerID(TimerHandle_t timer);
