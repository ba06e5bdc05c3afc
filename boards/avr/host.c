/* An ATmega328P under simavr: runs to a cycle, and stops early at whatever its SPI and chip select do.
   core.py compiles this against Debian's libsimavr-dev and calls it. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sim_avr.h>
#include <sim_elf.h>
#include <sim_io.h>
#include <sim_irq.h>
#include <sim_cycle_timers.h>
#include <avr_ioport.h>
#include <avr_spi.h>

enum { PLACES = 8 };
typedef struct {
    avr_t *avr;
    avr_irq_t *answer, *pin;
    avr_spi_t *spi;
    int waiting;             /* events not yet taken */
    int events[PLACES];      /* 0..255: a byte is through; 256, 257: chip select is low, high */
} Core;

static void event(Core *c, int what)
{
    if (c->waiting < PLACES)
        c->events[c->waiting++] = what;
    c->avr->run_cycle_count = 0; /* the batch of instructions ends here */
}

static void byte_through(avr_irq_t *irq, uint32_t value, void *core) { (void)irq, event(core, (int)(value & 255)); }
static void selected(avr_irq_t *irq, uint32_t value, void *core)
{
    if (value != irq->value)
        event(core, value ? 257 : 256);
}
/* simavr 1.6 gives every byte 100 us; here it takes its eight clocks (ATmega328P, table 19-5). */
static void written(avr_irq_t *irq, uint32_t value, void *core)
{
    static const int dividers[] = {4, 16, 64, 128};
    Core *c = core;
    (void)irq, (void)value;
    for (avr_cycle_timer_slot_p slot = c->avr->cycle_timers.timer; slot; slot = slot->next)
        if (slot->param == c->spi) {
            avr_cycle_timer_t through = slot->timer;
            int divider = dividers[c->avr->data[c->spi->r_spcr] & 3] >> (c->avr->data[c->spi->r_spsr] & 1);
            avr_cycle_timer_cancel(c->avr, through, c->spi);
            avr_cycle_timer_register(c->avr, (avr_cycle_count_t)(8 * divider), through, c->spi);
            return;
        }
}
static void no_sleep(avr_t *avr, avr_cycle_count_t cycles) { (void)avr, (void)cycles; }
static avr_cycle_count_t here(avr_t *avr, avr_cycle_count_t when, void *none)
{ return (void)avr, (void)when, (void)none, 0; }
static void quiet(avr_t *avr, const int level, const char *format, va_list list)
{ (void)avr, (void)level, (void)format, (void)list; }

/* select: pin of port B, interrupt: pin of port D; 0: the file is no ELF for an AVR. */
Core *core_open(const char *elf, uint32_t hz, int select, int interrupt)
{
    elf_firmware_t firmware;
    Core *c = calloc(1, sizeof *c);
    memset(&firmware, 0, sizeof firmware);
    avr_global_logger_set(quiet);
    if (!c || elf_read_firmware(elf, &firmware) || !firmware.flash || !(c->avr = avr_make_mcu_by_name("atmega328p")))
        return free(c), NULL;
    avr_init(c->avr);
    c->avr->frequency = hz;
    c->avr->sleep = no_sleep;
    firmware.frequency = hz;
    avr_load_firmware(c->avr, &firmware);
    c->answer = avr_io_getirq(c->avr, AVR_IOCTL_SPI_GETIRQ(0), SPI_IRQ_INPUT);
    c->pin = avr_io_getirq(c->avr, AVR_IOCTL_IOPORT_GETIRQ('D'), interrupt);
    avr_irq_register_notify(avr_io_getirq(c->avr, AVR_IOCTL_SPI_GETIRQ(0), SPI_IRQ_OUTPUT), byte_through, c);
    avr_irq_register_notify(avr_io_getirq(c->avr, AVR_IOCTL_IOPORT_GETIRQ('B'), select), selected, c);
    for (avr_io_t *io = c->avr->io_port; io; io = io->next)
        if (strcmp(io->kind, "spi") == 0)
            c->spi = (avr_spi_t *)io;
    avr_irq_register_notify(avr_iomem_getirq(c->avr, c->spi->r_spdr, NULL, AVR_IOMEM_IRQ_ALL), written, c);
    return c;
}

/* Run until the cycle, or an event: *what is it, or -1. Returns the cycle; -1: it halts for good, -2: it crashed. */
int64_t core_run(Core *c, int64_t until, int *what)
{
    avr_t *avr = c->avr;
    avr_cycle_timer_cancel(avr, here, c);
    if ((int64_t)avr->cycle < until)
        avr_cycle_timer_register(avr, (avr_cycle_count_t)(until - (int64_t)avr->cycle), here, c); /* sleep ends there */
    while (!c->waiting && (int64_t)avr->cycle < until) {
        int state = avr_run(avr);
        if (state == cpu_Done || state == cpu_Crashed)
            return state == cpu_Done ? -1 : -2;
    }
    *what = -1;
    if (c->waiting) {
        *what = c->events[0];
        memmove(c->events, c->events + 1, sizeof(int) * (size_t)--c->waiting);
    }
    return (int64_t)avr->cycle;
}

/* Asleep: the cycle that something inside ends it at, or any pin earlier; awake: 0. */
int64_t core_asleep(Core *c)
{
    avr_cycle_timer_cancel(c->avr, here, c);
    if (c->avr->state != cpu_Sleeping || c->waiting)
        return 0;
    return c->avr->cycle_timers.timer ? (int64_t)c->avr->cycle_timers.timer->when : INT64_MAX;
}

void core_answer(Core *c, int byte) { avr_raise_irq(c->answer, (uint32_t)byte); }
void core_interrupt(Core *c, int level) { avr_raise_irq(c->pin, (uint32_t)level); }
void core_reset(Core *c)
{
    c->waiting = 0;
    avr_reset(c->avr);
    c->pin->value = 0; /* the reset forgets levels of pins, and the same level again would not be told */
    avr_raise_irq(c->pin, 1);
}
int64_t core_cycle(Core *c) { return (int64_t)c->avr->cycle; }
