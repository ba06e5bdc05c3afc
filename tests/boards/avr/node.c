/* A motor velocity board for an ATmega328P with an MCP2515: TACH every 10 ms, heartbeat every second, commands.
   Written for these tests from the data sheets; the count is of timer 0, as nothing turns. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <stdint.h>

#ifndef DEVICE
#define DEVICE 0x31
#endif
enum { RESET = 0xC0, READ = 0x03, WRITE = 0x02, RTS = 0x80, LOAD = 0x40, FETCH = 0x90 };
static volatile uint8_t due;

static uint8_t swap(uint8_t byte)
{
    SPDR = byte;
    while (!(SPSR & (1 << SPIF)))
        ;
    return SPDR;
}
static void low(void) { PORTB &= (uint8_t)~(1 << PB2); }
static void high(void) { PORTB |= 1 << PB2; }
static void write(uint8_t address, uint8_t value) { low(), swap(WRITE), swap(address), swap(value), high(); }
static uint8_t read(uint8_t address)
{
    low(), swap(READ), swap(address);
    uint8_t value = swap(0);
    return high(), value;
}

static void send(uint8_t buffer, uint16_t identifier, const uint8_t *data)
{
    while (read((uint8_t)(0x30 + 0x10 * buffer)) & 8)
        ;
    low(), swap((uint8_t)(LOAD | buffer * 2)), swap((uint8_t)(identifier >> 3)), swap((uint8_t)(identifier << 5));
    swap(0), swap(0), swap(8);
    for (uint8_t k = 0; k < 8; k++)
        swap(data[k]);
    high(), low(), swap((uint8_t)(RTS | 1 << buffer)), high();
}

ISR(TIMER1_COMPA_vect) { due++; }
ISR(INT0_vect) { }

static void serve(void)
{
    uint8_t head[5], data[8];
    low(), swap(FETCH);
    for (uint8_t k = 0; k < 5; k++)
        head[k] = swap(0);
    for (uint8_t k = 0; k < 8; k++)
        data[k] = swap(0);
    high();
    if ((head[4] & 15) == 8) {
        uint8_t reply[8] = {DEVICE, data[1], data[1] != 1};
        send(0, 0x100 + DEVICE, reply);
    }
}

int main(void)
{
    uint32_t ticks = 0;
    DDRB = 1 << PB2 | 1 << PB3 | 1 << PB5;
    high();
    SPCR = 1 << SPE | 1 << MSTR; /* 8 MHz */
    SPSR = 1 << SPI2X;
    low(), swap(RESET), high();
    write(0x2A, 0x00), write(0x29, 0xD0), write(0x28, 0x82); /* 1 Mbit/s at 16 MHz, CNF1 to CNF3 */
    write(0x20, 0xFF), write(0x21, 0xE0), write(0x24, 0xFF), write(0x25, 0xE0); /* both masks: all bits */
    for (uint8_t filter = 0; filter <= 4; filter += 4)
        write(filter, (0x080 + DEVICE) >> 3), write(filter + 1, (uint8_t)(DEVICE << 5));
    write(0x2B, 0x01), write(0x0F, 0x00);
    OCR1A = 19999; /* 10 ms of 16 MHz / 8 */
    TCCR1B = 1 << WGM12 | 1 << CS11;
    TIMSK1 = 1 << OCIE1A;
    EICRA = 1 << ISC01; /* INT0 falls; a fall before the sleep still ends it */
    EIMSK = 1;
    sei();
    for (;;) {
        while (!(PIND & (1 << PD2)) && (read(0x2C) & 1))
            serve(); /* reading the buffer by its instruction clears the flag */
        cli();
        if (!due && PIND & (1 << PD2)) {
            set_sleep_mode(SLEEP_MODE_IDLE);
            sleep_enable();
            sei();
            sleep_cpu();
            sleep_disable();
            cli();
        }
        uint8_t now = due;
        due = 0;
        sei();
        for (; now; now--) {
            uint8_t tach[8] = {DEVICE, 0, (uint8_t)ticks, (uint8_t)(ticks >> 8), (uint8_t)(ticks >> 16),
                               (uint8_t)(ticks >> 24), 1, 0};
            send(1, 0x200 + DEVICE, tach);
            if (ticks++ % 100 == 0) {
                uint32_t s = ticks / 100;
                uint8_t alive[8] = {DEVICE, 0xF7, 1, (uint8_t)s, (uint8_t)(s >> 8)};
                send(2, 0x700 + DEVICE, alive);
            }
        }
    }
}
