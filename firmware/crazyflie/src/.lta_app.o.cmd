cmd_/tmp/w/d/boards/firmware/crazyflie/src/lta_app.o := arm-none-eabi-gcc -Wp,-MD,/tmp/w/d/boards/firmware/crazyflie/src/.lta_app.o.d     -I/tmp/w/d/boards/firmware/crazyflie/src -D__firmware__ -fno-exceptions -Wall -Wmissing-braces -fno-strict-aliasing -ffunction-sections -fdata-sections -Wdouble-promotion -std=gnu11 -DCRAZYFLIE_FW   -I/tmp/w/d/boards-fw/crazyflie-firmware/vendor/CMSIS/CMSIS/Core/Include   -I/tmp/w/d/boards-fw/crazyflie-firmware/vendor/CMSIS/CMSIS/DSP/Include   -I/tmp/w/d/boards-fw/crazyflie-firmware/vendor/libdw1000/inc   -I/tmp/w/d/boards-fw/crazyflie-firmware/vendor/FreeRTOS/include   -I/tmp/w/d/boards-fw/crazyflie-firmware/vendor/FreeRTOS/portable/GCC/ARM_CM4F   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/config   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/platform/interface   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/deck/interface   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/deck/drivers/interface   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/drivers/interface   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/drivers/bosch/interface   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/drivers/esp32/interface   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/hal/interface   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/kalman_core   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/lighthouse   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/outlierfilter   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/cpx   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/p2pDTR   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/controller   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/estimator   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/utils/interface   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/utils/interface/kve   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/utils/interface/lighthouse   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/utils/interface/tdoa   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/lib/FatFS   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/lib/CMSIS/STM32F4xx/Include   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/lib/STM32_USB_Device_Library/Core/inc   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/lib/STM32_USB_OTG_Driver/inc   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/lib/STM32F4xx_StdPeriph_Driver/inc   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/lib/vl53l1   -I/tmp/w/d/boards-fw/crazyflie-firmware/src/lib/vl53l1/core/inc   -I/tmp/w/d/boards/firmware/crazyflie/build/include/generated -fno-delete-null-pointer-checks -Wno-unused-but-set-variable -Wno-unused-const-variable -fomit-frame-pointer -fno-var-tracking-assignments -Wno-pointer-sign -fno-strict-overflow -fconserve-stack -Werror=implicit-int -Werror=date-time -DCC_HAVE_ASM_GOTO -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -g3 -fno-math-errno -DARM_MATH_CM4 -D__FPU_PRESENT=1 -mfp16-format=ieee -Wno-array-bounds -Wno-stringop-overread -Wno-stringop-overflow -DSTM32F4XX -DSTM32F40_41xxx -DHSE_VALUE=8000000 -DUSE_STDPERIPH_DRIVER -Os -Werror   -I/tmp/w/d/boards/firmware/crazyflie/src   -I/tmp/w/d/boards/firmware/crazyflie/../identity -DLTA_COMMIT=0x635a1341u -DLTA_VEHICLE=0xc2a1317eu   -c -o /tmp/w/d/boards/firmware/crazyflie/src/lta_app.o /tmp/w/d/boards/firmware/crazyflie/src/lta_app.c

source_/tmp/w/d/boards/firmware/crazyflie/src/lta_app.o := /tmp/w/d/boards/firmware/crazyflie/src/lta_app.c

deps_/tmp/w/d/boards/firmware/crazyflie/src/lta_app.o := \
    $(wildcard include/config/enable/thrust/bat/compensated.h) \
  /usr/include/newlib/string.h \
  /usr/include/newlib/_ansi.h \
  /usr/include/newlib/newlib.h \
  /usr/include/newlib/_newlib_version.h \
  /usr/include/newlib/sys/config.h \
    $(wildcard include/config/h//.h) \
  /usr/include/newlib/machine/ieeefp.h \
  /usr/include/newlib/sys/features.h \
  /usr/include/newlib/sys/reent.h \
  /usr/include/newlib/_ansi.h \
  /usr/lib/gcc/arm-none-eabi/12.2.1/include/stddef.h \
  /usr/include/newlib/sys/_types.h \
  /usr/include/newlib/machine/_types.h \
  /usr/include/newlib/machine/_default_types.h \
  /usr/include/newlib/sys/lock.h \
  /usr/include/newlib/sys/cdefs.h \
  /usr/include/newlib/sys/_locale.h \
  /usr/include/newlib/strings.h \
  /usr/include/newlib/sys/string.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/vendor/FreeRTOS/include/FreeRTOS.h \
  /usr/lib/gcc/arm-none-eabi/12.2.1/include/stdint.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/config/FreeRTOSConfig.h \
    $(wildcard include/config/h.h) \
    $(wildcard include/config/debug/queue/monitor.h) \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/config/config.h \
    $(wildcard include/config/h/.h) \
    $(wildcard include/config/block/address.h) \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/drivers/interface/nrf24l01.h \
  /usr/lib/gcc/arm-none-eabi/12.2.1/include/stdbool.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/drivers/interface/nRF24L01reg.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/config/trace.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/hal/interface/usec_time.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/utils/interface/cfassert.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/vendor/FreeRTOS/include/projdefs.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/vendor/FreeRTOS/include/portable.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/vendor/FreeRTOS/include/deprecated_definitions.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/vendor/FreeRTOS/portable/GCC/ARM_CM4F/portmacro.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/vendor/FreeRTOS/include/mpu_wrappers.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/app.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/app_channel.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/crtp.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/commander.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/config/config.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/stabilizer_types.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/hal/interface/imu_types.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/utils/interface/lighthouse/lighthouse_types.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/controller/controller.h \
    $(wildcard include/config/controller/oot.h) \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/stabilizer_types.h \
  /tmp/w/d/boards/firmware/crazyflie/src/lta_duties.h \
  /tmp/w/d/boards/firmware/crazyflie/../identity/lta_identity.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/param.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/param_logic.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/crtp.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/src/modules/interface/supervisor.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/vendor/FreeRTOS/include/task.h \
  /tmp/w/d/boards-fw/crazyflie-firmware/vendor/FreeRTOS/include/list.h \

/tmp/w/d/boards/firmware/crazyflie/src/lta_app.o: $(deps_/tmp/w/d/boards/firmware/crazyflie/src/lta_app.o)

$(deps_/tmp/w/d/boards/firmware/crazyflie/src/lta_app.o):
