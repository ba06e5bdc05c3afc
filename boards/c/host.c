/* The emulator's end of firmware.h: hands every call on to Python, and comes back from a routine that crashes or
 * hangs. Compiled once for every firmware, with the table CALLS of library.py before it. */
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>

#include "firmware.h"

#define STACK_BYTES 1048576 /* of a routine; the smallest usual stack of a thread is twice that */

static int64_t firmware_ask(void *host, int64_t what, int64_t a, int64_t b, void *data, int length);

/* The routine that this thread is in. inside: firmware's own code, not Python's that it called. */
struct routine {
    sigjmp_buf jump;
    void *host;
    char *stack;
    int64_t now_ns, output_ns;
    int64_t duties;  /* of write_pwm(), not yet told: with the next call, or at the end */
    int32_t encoder; /* its counter, handed in with the timer's routine; -1: has to be asked for */
    volatile sig_atomic_t inside;
    volatile unsigned long steps, seen;
};
/* Of a thread that has run a routine. A handler must not allocate: its storage is there from the thread's start. */
static __thread struct routine *current __attribute__((tls_model("initial-exec")));
#define here (*current)
static volatile unsigned long steps;
static struct sigaction before[NSIG];

static void caught(int signal) {
    int inside = current && here.inside;
    if (signal == SIGVTALRM && (!inside || here.steps != here.seen)) {
        if (inside)
            here.seen = here.steps;
        if (!inside && before[signal].sa_handler != SIG_DFL && before[signal].sa_handler != SIG_IGN)
            before[signal].sa_handler(signal); /* another firmware's library watches, too */
    } else if (inside) {
        siglongjmp(here.jump, signal);
    } else {
        sigaction(signal, &before[signal], NULL); /* not ours: it happens again, without us */
    }
}

/* A stack for the handlers, as firmware may have used up its own; once a process, the handlers themselves. */
static void prepare(void) {
    static const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGVTALRM};
    static int installed;
    stack_t stack = {.ss_size = 65536};
    struct sigaction action = {.sa_handler = caught, .sa_flags = SA_NODEFER | SA_ONSTACK | SA_RESTART};
    struct itimerval every = {{1, 0}, {1, 0}}; /* s of this process' own CPU time: hung after two */
    current = calloc(1, sizeof *current);
    if (sigaltstack(NULL, &stack) == 0 && (stack.ss_flags & SS_DISABLE)) {
        stack = (stack_t){.ss_sp = malloc(65536), .ss_size = 65536};
        sigaltstack(&stack, NULL);
    }
    if (installed)
        return;
    installed = 1;
    for (size_t k = 0; k < sizeof signals / sizeof *signals; k++)
        sigaction(signals[k], &action, &before[signals[k]]);
    setitimer(ITIMER_VIRTUAL, &every, NULL);
}

/* Runs a routine; arguments and result are those of Memory in library.py. block: its handle, then the memory. */
static int64_t enter(void **block, int routine, int64_t now_ns, int64_t output_ns, uint32_t number, int size,
                     const uint8_t *data, const struct frame *frame) {
    struct routine outer;
    struct board *memory = (struct board *)(block + 1);
    int64_t ended;
    if (!current)
        prepare();
    outer = here;
    here.host = *block;
    here.stack = (char *)&ended;
    here.now_ns = now_ns;
    here.output_ns = output_ns;
    here.duties = 0;
    here.encoder = routine == 1 && size ? (int32_t)number : -1;
    here.steps = ++steps;
    ended = sigsetjmp(here.jump, 0);
    if (!ended) {
        here.inside = 1;
        switch (routine) {
        case 0: board_reset(memory); break;
        case 1: board_timer(memory); break;
        case 2: board_frame(memory, frame); break;
        case 3: board_can(memory); break;
        case 4: board_sent(memory); break;
        default: board_init(memory, (uint8_t)number, (const int32_t *)(const void *)data);
        }
    }
    ended |= here.duties;
    here = outer;
    return ended;
}

static int64_t firmware_run(void **block, int routine, int64_t now_ns, int64_t output_ns, uint32_t number, int size,
                            const uint8_t *data) {
    return enter(block, routine, now_ns, output_ns, number, size, data, NULL);
}

static int64_t firmware_frame(void **block, int64_t now_ns, uint32_t identifier, int extended, int remote, int size,
                              const uint8_t *data) {
    struct frame frame = {identifier, (uint8_t)extended, (uint8_t)remote, (uint8_t)size, {0}};
    memcpy(frame.data, data, size < 8 ? (size_t)size : 8);
    return enter(block, 2, now_ns, now_ns, 0, 0, NULL, &frame);
}

static int64_t ask(int64_t what, int64_t a, int64_t b, const void *data, size_t length) {
    int64_t found;
    what |= here.duties;
    here.duties = 0;
    if (here.stack - (char *)&found > STACK_BYTES)
        siglongjmp(here.jump, SIGSEGV); /* Python, which could not come back, would find no stack left */
    here.inside = 0;
    found = firmware_ask(here.host, what, a, b, (void *)data, (int)length);
    here.steps = ++steps;
    here.inside = 1;
    return found;
}

int64_t time_ns(void) { return here.now_ns; }
int64_t output_ns(void) { return here.output_ns; }
uint32_t crystal_100us(void) { return (uint32_t)ask(CRYSTAL_100US, 0, 0, NULL, 0); }
uint16_t read_encoder(void) {
    int32_t known = here.encoder;
    here.encoder = -1;
    return (uint16_t)(known >= 0 ? known : ask(READ_ENCODER, 0, 0, NULL, 0));
}
uint16_t read_current(uint8_t motor) { return (uint16_t)ask(READ_CURRENT, motor, 0, NULL, 0); }
uint32_t read_endat(void) { return (uint32_t)ask(READ_ENDAT, 0, 0, NULL, 0); }
void write_pwm(uint16_t a, uint16_t b) { here.duties = INT64_C(1) << 40 | (int64_t)a << 24 | (int64_t)b << 8; }
void write_pwm_q16(uint32_t a, uint32_t b) { ask(WRITE_PWM_Q16, a, b, NULL, 0); }
void can_filter(uint8_t number, uint16_t mask, uint16_t identifier) {
    ask(CAN_FILTER, number, (int64_t)mask << 16 | identifier, NULL, 0);
}
uint8_t can_send(uint16_t identifier, const uint8_t data[8]) {
    return (uint8_t)ask(CAN_SEND, identifier, 0, data, 8);
}
void can_withdraw(uint16_t identifier) { ask(CAN_WITHDRAW, identifier, 0, NULL, 0); }
uint8_t can_free(void) { return (uint8_t)ask(CAN_FREE, 0, 0, NULL, 0); }
uint8_t can_state(void) { return (uint8_t)ask(CAN_STATE, 0, 0, NULL, 0); }
uint16_t can_tec(void) { return (uint16_t)ask(CAN_TEC, 0, 0, NULL, 0); }
void request_can(void) { ask(REQUEST_CAN, 0, 0, NULL, 0); }
void can_notify(void) { ask(CAN_NOTIFY, 0, 0, NULL, 0); }
uint8_t uart_send(const uint8_t *data, uint16_t length, uint8_t more) {
    return (uint8_t)ask(UART_SEND, more, 0, data, length);
}
void book_cycles(uint32_t timer, uint16_t pwm) { ask(BOOK_CYCLES, timer, pwm, NULL, 0); }
uint32_t lost_interrupts(void) { return (uint32_t)ask(LOST_INTERRUPTS, 0, 0, NULL, 0); }
void count_dropped(void) { ask(COUNT_DROPPED, 0, 0, NULL, 0); }
void debug_line(const char *text) { ask(DEBUG_LINE, 0, 0, text, strlen(text)); }
