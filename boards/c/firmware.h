/* What firmware in C provides and what it may call.
 *
 * The emulator compiles one C file that includes this header. All memory of a board is its `struct board`:
 * two boards made of one file, power loss and snapshots rest on that, so a writable variable elsewhere is refused.
 * The memory is zero when a board is made, and keeps its contents through a loss of power.
 * Every output takes effect at the end of the routine that writes it.
 */
#ifndef SCHMIDT_FIRMWARE_H
#define SCHMIDT_FIRMWARE_H

#include <stdint.h>

/* --- provided by the firmware ---------------------------------------------------------------------------- */

struct board; /* members without pointers: a snapshot is the bytes of it */

struct interrupt {
    uint8_t priority;        /* the timer's is the highest */
    uint16_t latency_cycles; /* from the request to the first instruction */
    uint16_t cost_cycles;    /* the routine, return included */
};

struct firmware {
    uint16_t memory_bytes; /* sizeof(struct board) */
    uint32_t fcy_hz;       /* instruction cycles a second */
    uint32_t period_us;    /* of the timer */
    struct interrupt timer, can;
};

extern const struct firmware firmware;

struct frame {
    uint32_t identifier; /* 11 bits, or 29 when extended */
    uint8_t extended, remote, length;
    uint8_t data[8];
};

/* Once, when the board is made: filters, and what was set when it was programmed (boards/axis/config.py).
 * device: its device type. */
void board_init(struct board *, uint8_t device, const int32_t *settings);

/* After power-up. What has to be forgotten is forgotten here. */
void board_reset(struct board *);

/* The timer's interrupt. */
void board_timer(struct board *);

/* A frame has passed the filters; called at its end, takes no time. Keep it, call request_can() and go. */
void board_frame(struct board *, const struct frame *);

/* The CAN interrupt that request_can() has asked for. */
void board_can(struct board *);

/* A frame has left its buffer after can_notify(). */
void board_sent(struct board *);

/* --- provided by the chips ------------------------------------------------------------------------------- */

/* The board's own clock, ns since it began to run: timer interrupts counted, and the timer read in between.
 * At a timer interrupt it has counted that one already. */
int64_t time_ns(void);

/* The same at the end of this routine. */
int64_t output_ns(void);

/* The crystal's own count since it was powered, 100 us, modulo 2^32. */
uint32_t crystal_100us(void);

/* Counter of the quadrature encoder, modulo 2^16. */
uint16_t read_encoder(void);

/* 10 bits of motor 0 or 1: 6.1 mA a count (boards/silicon/adc.py). */
uint16_t read_current(uint8_t motor);

/* An EnDat transfer: 29 bits of position; bit 30: alarm; bit 31: wrong CRC. */
uint32_t read_endat(void);

/* Both duty registers, PWM steps. */
void write_pwm(uint16_t a, uint16_t b);

/* Both duties in Q16; a PWM interrupt spreads the fractions over periods. */
void write_pwm_q16(uint32_t a, uint32_t b);

/* Acceptance filter 0..5; 0 and 1 share a mask, as 2..5 do. For board_init(). */
void can_filter(uint8_t number, uint16_t mask, uint16_t identifier);

/* Load a transmit buffer with a standard frame of eight bytes; 0: all three are full. */
uint8_t can_send(uint16_t identifier, const uint8_t data[8]);

/* Take the last frame sent with this identifier back unless it is on the bus. */
void can_withdraw(uint16_t identifier);

/* Transmit buffers that are empty. */
uint8_t can_free(void);

/* Error state, 0 active, 1 passive, 2 bus off, and TEC. */
uint8_t can_state(void);
uint16_t can_tec(void);

/* Have board_can() run, or board_sent() once when a frame has left. */
void request_can(void);
void can_notify(void);

/* Transmit bytes on RS232; 0: both buffers are full. more: they are no whole packet, the rest follows. */
uint8_t uart_send(const uint8_t *data, uint16_t length, uint8_t more);

/* --- what only an emulator can ask ----------------------------------------------------------------------- */

/* From now on the timer's routine costs so many cycles, and a PWM interrupt so many every PWM period (0: none). */
void book_cycles(uint32_t timer, uint16_t pwm);

/* Interrupts lost so far. */
uint32_t lost_interrupts(void);

/* Count something that found no room: for the run's summary. */
void count_dropped(void);

/* A line for whoever debugs, with the simulated time and the board's name. */
void debug_line(const char *text);

#endif
