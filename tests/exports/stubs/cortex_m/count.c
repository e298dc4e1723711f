/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Starts a flight program `prog` on a Cortex-M with FPU, and counts the instructions of those of
 * its functions that the linker's --wrap names: prog_estimate and prog_control, which are a step
 * together, or prog_law_step. Prints how often they ran, instructions in all, the most of one step,
 * and ticks of the clock in 300,000 instructions.
 *
 * The clock is SysTick. Under an emulator whose time advances by the same amount with each
 * instruction it is a counter of instructions; a loop of known length says how many ticks each
 * takes.
 */
#include <stdint.h>
#include <stdio.h>
#include <unistd.h>

#define SYSTICK_CONTROL (*(volatile uint32_t *)0xE000E010u)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xE000E014u)
#define SYSTICK_VALUE (*(volatile uint32_t *)0xE000E018u) /* counts down, 24 bits */
#define CPACR (*(volatile uint32_t *)0xE000ED88u)
#define END_OF_RAM 0x00400000u

void _start(void); /* of the C library */

static void reset(void) {
  CPACR |= 0xFu << 20; /* the FPU */
  __asm volatile("dsb\n\tisb" ::: "memory");
  _start();
}

static void fault(void) { _exit(3); }

/* The processor reads them at address 0. */
__attribute__((section(".vectors"), used)) static void (*const vectors[])(void) = {
    (void (*)(void))END_OF_RAM, reset, fault, fault, fault, fault, fault};

#define TICKS_SINCE(begin) (((begin)-SYSTICK_VALUE) & 0xFFFFFFu)
#define ROUNDS 100000u
#define FEW_ROUNDS 1000u

static uint32_t loop_ticks; /* of ROUNDS */
static uint32_t call_ticks; /* of a call, the return, and the clock's second reading */
static uint32_t calls, of_estimate, most;
static uint64_t sum;

/* Three instructions a round, one of them slow, and the return. */
__attribute__((noinline)) static void loop(uint32_t rounds) {
  __asm volatile("1: vsqrt.f32 s15, s15\n\tsubs %0, #1\n\tbne 1b" : "+l"(rounds) : : "cc", "s15");
}

__attribute__((noinline)) static uint32_t ticks_of_loop(uint32_t rounds) {
  const uint32_t begin = SYSTICK_VALUE;
  loop(rounds);
  return TICKS_SINCE(begin);
}

__attribute__((constructor)) static void calibrate(void) {
  SYSTICK_RELOAD = 0xFFFFFFu;
  SYSTICK_VALUE = 0u;
  SYSTICK_CONTROL = 5u;            /* on, by the processor's clock, without interrupts */
  (void)ticks_of_loop(FEW_ROUNDS); /* the emulator has translated it now */
  const uint32_t few = ticks_of_loop(FEW_ROUNDS);
  loop_ticks = ticks_of_loop(FEW_ROUNDS + ROUNDS) - few;
  call_ticks = few - (loop_ticks / (ROUNDS / FEW_ROUNDS));
}

static uint32_t instructions(uint32_t ticks) {
  return (uint32_t)((((uint64_t)(ticks - call_ticks) * 3u * ROUNDS) + (loop_ticks / 2u)) /
                    loop_ticks);
}

static void add(uint32_t count) {
  ++calls;
  sum += count;
  most = (count > most) ? count : most;
}

/* Weak, as not every program has every function. */
#define COUNTED(name, parameters)                      \
  void __real_##name parameters __attribute__((weak)); \
  void __wrap_##name parameters;                       \
  void __wrap_##name parameters

COUNTED(prog_estimate, (void *state, const void *sensors, void *estimate)) {
  const uint32_t begin = SYSTICK_VALUE;
  __real_prog_estimate(state, sensors, estimate);
  of_estimate = instructions(TICKS_SINCE(begin));
}

COUNTED(prog_control, (void *state, const void *estimate, const void *reference, void *output)) {
  const uint32_t begin = SYSTICK_VALUE;
  __real_prog_control(state, estimate, reference, output);
  add(of_estimate + instructions(TICKS_SINCE(begin)));
}

COUNTED(prog_law_step, (const void *parameters, void *state, const void *estimate,
                        const void *reference, void *inputs)) {
  const uint32_t begin = SYSTICK_VALUE;
  __real_prog_law_step(parameters, state, estimate, reference, inputs);
  add(instructions(TICKS_SINCE(begin)));
}

__attribute__((destructor)) static void tell(void) {
  printf("%lu %lu %lu %lu\n", (unsigned long)calls, (unsigned long)sum, (unsigned long)most,
         (unsigned long)loop_ticks);
}
