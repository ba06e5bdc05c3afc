/* Firmware of the axis board in C, as for a dsPIC30F3011 with an MCP2515: frame for frame what boards/axis/ is in
 * Python, which says why things are done as they are. One part of this file is one file there.
 *
 * Integers of 16 and 32 bits, of 64 where the Python board declares them (times, positions in Q18 counts, products);
 * no floating point, no allocation. It needs two's complement and a right shift that keeps the sign, as every
 * compiler for these controllers has them. A left shift is written as a product where the number may be negative.
 */
#include "firmware.h"

typedef char a_right_shift_keeps_the_sign[-1 >> 1 == -1 ? 1 : -1]; /* C99: the chip's own compiler is a GCC 4.5 */

#define INT32_TOP INT32_C(0x7FFFFFFF)
#define Q16 INT32_C(65536)
#define SHARE_SHIFT 5 /* counter.py */
#define Q18 INT64_C(262144)
#define SECTIONS 4
#define SLOWEST INT32_C(142723) /* observer.py: 5 and 25 arcsec/s in Q16 counts a tick */
#define FASTEST INT32_C(713614)
#define STILL_TICKS 100
#define RAMP INT32_C(428)
#define TRIM INT32_C(114178)
#define OWED INT32_C(114178276)
#define GUST_TICKS 1024
#define GUST_LOUD (INT32_C(13107) * GUST_TICKS)
#define GUST_QUIET (INT32_C(9175) * GUST_TICKS)
#define UNITS_PER_STEP INT32_C(55125) /* Q18 counts in a step of the absolute encoder, exactly */
#define COUNTS_PER_TURN INT32_C(112896000)
#define STEPS_MASK INT32_C(0x1FFFFFFF)
#define RATE_LIMIT INT32_C(318557389) /* 3.1 deg/s in Q16 counts a tick */
#define GAIN_TOP INT32_C(1048576)
#define EFFORT_Q8 INT32_C(768000) /* all of the supply */
#define STALE_NS INT64_C(50000000)
#define OLDEST_NS INT64_C(100000000)
#define MISSING_NS INT64_C(25000000)
#define WARNING_NS INT64_C(10000000000)
#define SETTLE_TICKS 100
#define EFFORT_SCALE 3000
#define INBOX 8
#define HARMONICS 8
#define SAMPLES 25
#define SAMPLE_BYTES 24
#define NO_SETPOINT INT32_MIN

enum { COMMAND = 0x080, REPLY = 0x100, MEASUREMENT = 0x200, SUMMARY = 0x300, HEARTBEAT = 0x700 };
enum { PING = 1, GET_PARAMETER, SET_PARAMETER };
enum { POWER = 0x10, STOP_NOW, SET_RATE, SET_CLASS, MOVE_TO, TRACK_RATE, OPEN_LOOP_EFFORT, NUDGE };
enum { OK, UNKNOWN_OPCODE, WRONG_LENGTH, OUT_OF_RANGE, NOT_ALLOWED, WRONG_DEVICE_TYPE };
enum { ALARM = 1, WRONG_CRC = 4, LIMIT_LOW = 8, LIMIT_HIGH = 16 }; /* POSITION's flags */
enum { OFF, STOP, RATE, CLASS, MOVE, TRACK, OPEN_LOOP };
enum { READY = 1, ACTIVE, FAULT };
enum { MOVING = 0x10, SOFT_LIMIT = 0x20, FAULTY = 0x40, POWERED = 0x80 }; /* above the mode, in MOTION's status */
enum {
    SENSOR = 0x01, STALE = 0x02, BUS = 0x04, OVERRUN = 0x08, DROPPED = 0x10, LIMIT = 0x20, FAULT_BIT = 0x40,
    FOREIGN = 0x80, CLIPPED = 0x100
};
enum { /* parameters by number */
    SPLIT = 1, KP, KI, LOW, HIGH, ACCELERATION, CLASSES, SPREAD = 12, COMPENSATION, LEVEL, TRAVEL, LINES,
    BIAS = 40, LOCK, BLEND, OBSERVER, SECTION, THROUGH = SECTION + 24, PARAMETERS
};
enum { /* settings by place: boards/axis/config.py */
    KP_POINTING = 11, KI_POINTING, KI_CREEP, KP_GUST, KI_GUST, FADE, PWM_STEPS, GAIN, CORRECTION, CREEP_RATE, LAG,
    SETTLE, FRAME_NS, PEERS, SETTINGS = PEERS + 4
};

struct tachometer {
    int64_t latch_ns;
    int32_t count, rate_q8;
    uint32_t last;
    uint8_t known;
};

struct board {
    int64_t foreign_ns, clipped_ns, dropped_ns;             /* when it last happened */
    int64_t good_ns, latch_ns;                              /* of the absolute position */
    int64_t target, remaining, speed, profile_rate, top;    /* profile, Q18 counts (a tick) */
    int64_t blend_q18, watch_q18, reciprocal_q32;
    int64_t auxiliary_latch_ns;
    struct tachometer tach[2];
    int32_t settings[SETTINGS];
    int32_t p[PARAMETERS];
    int32_t effort_q16, pi_error, kp, ki;                   /* the loop, with the gains in force */
    int32_t position, rate, setpoint_q16, wanted_q16;
    int32_t gust_fast_q16, gust_slow_q16, gust_sum;         /* what wind leaves of the velocity error */
    int32_t lock_q16, friction_q16, watch_counts, auxiliary_position, auxiliary_rate_q8;
    uint32_t ticks;
    int16_t velocity, effort, effort_command;
    uint16_t poscnt, counter;
    int32_t share_q16;                                      /* of the counter torque, smoothed */
    int32_t states[2 * SECTIONS], owed_q16, rate_q16, held_q16, correction_q16; /* of the observer */
    uint8_t still, driving;
    uint16_t gust_ticks;
    uint8_t gust_turned, blowing;
    uint8_t device, mode, selected, near_ticks;
    uint8_t fault, fixed, reached, watching, blending;      /* fixed: the effort is commanded */
    uint8_t first, waiting, late, late_reply[8];            /* inbox and a reply that found no buffer */
    uint8_t inbox[INBOX][9];                                /* length, data */
    uint8_t sequence, samples, clip_packet, ends;           /* ends: limit bits of the last POSITION */
    uint16_t crc;
    uint8_t packet[8 + SAMPLE_BYTES + 2];                   /* the part that leaves: a sample, head or CRC with it */
};

const struct firmware firmware = {
    .memory_bytes = sizeof(struct board), .fcy_hz = 30000000, .period_us = 5000,
    .timer = {6, 9, 1200}, .can = {4, 9, 900},
};

/* --- integers: boards/core/widths.py ---------------------------------------------------------------------- */

static int64_t quotient(int64_t a, int64_t b) { /* rounded down; b > 0 */
    return a / b - (a % b < 0);
}

static int64_t limited(int64_t value, int64_t top) { return value > top ? top : value < -top ? -top : value; }

static int64_t size_of(int64_t value) { return value < 0 ? -value : value; }

static int32_t i32(const uint8_t *data) {
    return (int32_t)((uint32_t)data[0] | (uint32_t)data[1] << 8 | (uint32_t)data[2] << 16 | (uint32_t)data[3] << 24);
}

static void put(uint8_t *data, uint8_t bytes, uint64_t value) {
    while (bytes--) {
        *data++ = (uint8_t)value;
        value >>= 8;
    }
}

static int64_t root(int64_t radicand) { /* rounded down */
    uint64_t rest = (uint64_t)radicand, found = 0, bit = UINT64_C(1) << 62;
    for (; bit; bit >>= 2) {
        if (rest >= found + bit) {
            rest -= found + bit;
            found = (found >> 1) + bit;
        } else {
            found >>= 1;
        }
    }
    return (int64_t)found;
}

/* --- what all boards do: boards/core/board.py ------------------------------------------------------------- */

static void drop(struct board *b) {
    count_dropped();
    b->dropped_ns = time_ns();
}

static void clip(struct board *b) { b->clipped_ns = time_ns(); }

static int64_t fitted(int64_t value, int64_t low, int64_t high, uint8_t *cut) {
    if (value >= low && value <= high) return value;
    *cut = 1;
    return value < low ? low : high;
}

static void transmit(struct board *b, uint16_t base, const uint8_t *data) {
    if (!can_send((uint16_t)(base + b->device), data)) drop(b);
}

static void refresh(struct board *b, uint16_t base, const uint8_t *data) {
    can_withdraw((uint16_t)(base + b->device));
    transmit(b, base, data);
}

static void reply_late(struct board *b) {
    if (!b->late) return;
    b->late = 0;
    transmit(b, REPLY, b->late_reply);
    if (b->waiting) request_can();
}

static void heartbeat(struct board *b, uint8_t state) {
    uint8_t data[8] = {b->device, 0xF7, state};
    uint32_t lost = lost_interrupts();
    uint16_t tec = can_tec();
    if (b->late && can_free()) reply_late(b);
    put(data + 3, 2, (uint64_t)(output_ns() / 1000000000));
    put(data + 5, 2, lost > 0xFFFF ? 0xFFFF : lost);
    data[7] = (uint8_t)(tec > 0xFF ? 0xFF : tec);
    refresh(b, HEARTBEAT, data);
}

/* --- the loop: pi.py and counter.py ----------------------------------------------------------------------- */

static int64_t effort_limit(const struct board *b) {
    return limited((int64_t)b->settings[PWM_STEPS] * Q16, INT32_TOP);
}

static int16_t steps_of(int64_t effort_q16) { return (int16_t)((effort_q16 + Q16 / 2) >> 16); }

static void pi_start(struct board *b, int32_t effort, int32_t setpoint_q16, int16_t velocity) {
    b->effort_q16 = (int32_t)limited((int64_t)effort * Q16, effort_limit(b));
    b->pi_error = (int32_t)limited(setpoint_q16 - (int64_t)velocity * Q16, INT32_TOP);
}

static int16_t pi_step(struct board *b, int64_t setpoint_q16) {
    int64_t error = limited(setpoint_q16 - (int64_t)b->velocity * Q16, INT32_TOP);
    int64_t change = limited(error - b->pi_error, INT32_TOP);
    int64_t effort = b->effort_q16 + ((b->kp * change + b->ki * error) >> 12);
    b->effort_q16 = (int32_t)limited(effort, effort_limit(b));
    b->pi_error = (int32_t)error;
    return steps_of(b->effort_q16);
}

static int64_t share_of(const struct board *b, int64_t share) { /* faded with the speed */
    int32_t fade = b->settings[FADE], left = fade - (int32_t)size_of(b->velocity);
    return fade ? share * (left > 0 ? left : 0) / fade : share;
}

static void counter_follow(struct board *b, int16_t effort) {
    int64_t share = share_of(b, size_of(effort) * b->p[SPLIT]);
    if (size_of(share - (int64_t)b->counter * 100) < 100) return;
    b->counter = (uint16_t)((share + 50) / 100);
}

/* --- small loops: hold.py, compensator.py, watch.py ------------------------------------------------------- */

static int64_t lock_step(struct board *b, int32_t setpoint_q16) {
    int64_t error = b->lock_q16 + (setpoint_q16 - (int64_t)b->velocity * Q16);
    b->lock_q16 = (int32_t)limited(error, 174 * Q16); /* 2 arcsec */
    return (int64_t)b->lock_q16 * b->settings[GAIN] >> 16;
}

static void gusts_start(struct board *b) {
    b->gust_fast_q16 = b->gust_slow_q16 = b->gust_sum = 0;
    b->gust_ticks = 0;
    b->gust_turned = b->blowing = 0;
}

static void gusts_step(struct board *b, int64_t error_q16) { /* gusts.py */
    int32_t error = (int32_t)limited(error_q16, 8 * Q16);
    uint8_t turned;
    b->gust_fast_q16 += (error - b->gust_fast_q16) >> 2;
    b->gust_slow_q16 += (b->gust_fast_q16 - b->gust_slow_q16) >> 4;
    b->gust_sum += (int32_t)size_of(b->gust_fast_q16 - b->gust_slow_q16);
    if (++b->gust_ticks < GUST_TICKS) return;
    turned = b->blowing ? b->gust_sum < GUST_QUIET : b->gust_sum > GUST_LOUD;
    if (turned && b->gust_turned) {
        b->blowing = !b->blowing;
        turned = 0;
    }
    b->gust_turned = turned;
    b->gust_sum = 0;
    b->gust_ticks = 0;
}

static int64_t blend_step(struct board *b, int64_t absolute_q18, uint8_t creeping) {
    if (b->blending && creeping) {
        int64_t position = b->blend_q18 + b->velocity * Q18;
        b->blend_q18 = position + ((absolute_q18 - position) >> b->p[BLEND]);
    } else {
        b->blending = 1;
        b->blend_q18 = absolute_q18;
    }
    return b->blend_q18;
}

static const int16_t quarter[257] = { /* 32767 sin, 1024 to a turn */
    0, 201, 402, 603, 804, 1005, 1206, 1407, 1608, 1809, 2009, 2210, 2410, 2611, 2811, 3012, 3212, 3412, 3612,
    3811, 4011, 4210, 4410, 4609, 4808, 5007, 5205, 5404, 5602, 5800, 5998, 6195, 6393, 6590, 6786, 6983, 7179,
    7375, 7571, 7767, 7962, 8157, 8351, 8545, 8739, 8933, 9126, 9319, 9512, 9704, 9896, 10087, 10278, 10469,
    10659, 10849, 11039, 11228, 11417, 11605, 11793, 11980, 12167, 12353, 12539, 12725, 12910, 13094, 13279,
    13462, 13645, 13828, 14010, 14191, 14372, 14553, 14732, 14912, 15090, 15269, 15446, 15623, 15800, 15976,
    16151, 16325, 16499, 16673, 16846, 17018, 17189, 17360, 17530, 17700, 17869, 18037, 18204, 18371, 18537,
    18703, 18868, 19032, 19195, 19357, 19519, 19680, 19841, 20000, 20159, 20317, 20475, 20631, 20787, 20942,
    21096, 21250, 21403, 21554, 21705, 21856, 22005, 22154, 22301, 22448, 22594, 22739, 22884, 23027, 23170,
    23311, 23452, 23592, 23731, 23870, 24007, 24143, 24279, 24413, 24547, 24680, 24811, 24942, 25072, 25201,
    25329, 25456, 25582, 25708, 25832, 25955, 26077, 26198, 26319, 26438, 26556, 26674, 26790, 26905, 27019,
    27133, 27245, 27356, 27466, 27575, 27683, 27790, 27896, 28001, 28105, 28208, 28310, 28411, 28510, 28609,
    28706, 28803, 28898, 28992, 29085, 29177, 29268, 29358, 29447, 29534, 29621, 29706, 29791, 29874, 29956,
    30037, 30117, 30195, 30273, 30349, 30424, 30498, 30571, 30643, 30714, 30783, 30852, 30919, 30985, 31050,
    31113, 31176, 31237, 31297, 31356, 31414, 31470, 31526, 31580, 31633, 31685, 31736, 31785, 31833, 31880,
    31926, 31971, 32014, 32057, 32098, 32137, 32176, 32213, 32250, 32285, 32318, 32351, 32382, 32412, 32441,
    32469, 32495, 32521, 32545, 32567, 32589, 32609, 32628, 32646, 32663, 32678, 32692, 32705, 32717, 32728,
    32737, 32745, 32752, 32757, 32761, 32765, 32766, 32767
};

static int32_t sine(uint16_t place) {
    uint16_t half = place & 511;
    int16_t value = quarter[half <= 256 ? half : 512 - half];
    return place & 512 ? -value : value;
}

static int32_t wave(uint32_t phase, uint16_t ahead) { /* between two values of the table */
    uint16_t place = (uint16_t)((phase >> 22) + ahead);
    int32_t part = (int32_t)(phase >> 10 & 0xFFF);
    return sine(place) + ((sine((uint16_t)(place + 1)) - sine(place)) * part >> 12);
}

static int32_t friction(struct board *b, int32_t setpoint_q16) {
    int32_t level = b->p[LEVEL] * 256, goal = setpoint_q16 >= 0 ? level : -level;
    int64_t share = size_of(setpoint_q16) * b->reciprocal_q32 >> 32;
    if (!level) return 0;
    if (share > Q16) share = Q16;
    b->friction_q16 += (int32_t)((goal - b->friction_q16) * share >> 16);
    return b->friction_q16;
}

static int64_t compensation_q16(struct board *b, int32_t setpoint_q16) {
    int64_t here = b->position + ((int64_t)b->velocity * 467479 >> 16); /* a tick and a half, in steps */
    int64_t total = 0;
    for (uint8_t line = LINES; line < LINES + 3 * HARMONICS; line = (uint8_t)(line + 3)) {
        uint32_t phase = (uint32_t)(here * b->p[line] >> 13);
        total += (int64_t)b->p[line + 1] * wave(phase, 256) + (int64_t)b->p[line + 2] * wave(phase, 0);
    }
    return (total >> 7) + friction(b, setpoint_q16);
}

static uint8_t encoders_disagree(struct board *b, int64_t position_q18) {
    int64_t parted = size_of(position_q18 - b->watch_q18 - b->watch_counts * Q18);
    uint8_t before = b->watching;
    b->watch_q18 = position_q18;
    b->watch_counts = 0;
    b->watching = 1;
    return before && parted > 3484 * Q18; /* 40 arcsec */
}

/* --- what other boards measure: tachometer.py, auxiliary.py ------------------------------------------------ */

static void tach_take(struct board *b, struct tachometer *tach, const uint8_t *data) {
    int16_t delta = (int16_t)(data[6] | (uint16_t)data[7] << 8);
    tach->count = i32(data + 2);
    tach->latch_ns = time_ns() - 40000 - b->settings[FRAME_NS];
    tach->rate_q8 += ((int32_t)delta * 256 - tach->rate_q8) >> 2;
}

static int32_t tach_sample(struct tachometer *tach, int64_t now_ns) {
    int64_t age = now_ns - tach->latch_ns;
    uint32_t now = (uint32_t)(tach->count + quotient(tach->rate_q8 * age, INT64_C(10000000) * 256));
    uint32_t last = tach->last;
    uint8_t known = tach->known;
    tach->known = age <= MISSING_NS;
    if (!tach->known) return 0;
    tach->last = now;
    return known ? (int32_t)(now - last) : tach->rate_q8 >> 8;
}

static void auxiliary_take(struct board *b, const uint8_t *data) {
    int32_t position = i32(data + 2) & 0x1FFFF;
    int64_t latch_ns = time_ns() - b->settings[FRAME_NS] - data[6] * INT32_C(4000);
    if (data[1] & 1)
        return; /* the lamp is out */
    if (latch_ns - b->auxiliary_latch_ns < MISSING_NS) {
        int32_t moved = ((position - b->auxiliary_position + 0x10000) & 0x1FFFF) - 0x10000;
        b->auxiliary_rate_q8 += (moved * 256 - b->auxiliary_rate_q8) >> 2;
    } else {
        b->auxiliary_rate_q8 = 0;
    }
    b->auxiliary_position = position;
    b->auxiliary_latch_ns = latch_ns;
}

static int32_t auxiliary_sample(const struct board *b, int64_t now_ns) {
    int64_t age = now_ns - b->auxiliary_latch_ns;
    if (age > MISSING_NS) return 0;
    return (int32_t)((b->auxiliary_position + quotient(b->auxiliary_rate_q8 * age, INT64_C(10000000) * 256)) & 0x1FFFF);
}

/* --- set points: motion.py, profile.py --------------------------------------------------------------------- */

static uint8_t pointing(const struct board *b) { return b->mode == MOVE || b->mode == TRACK; }

static uint8_t fresh(const struct board *b) { return time_ns() - b->good_ns < STALE_NS; }

static int64_t measured(const struct board *b, int64_t now_ns) {
    int64_t age = now_ns - b->latch_ns;
    if (age > OLDEST_NS) age = OLDEST_NS;
    return (int64_t)b->position * UNITS_PER_STEP + (b->velocity * age * 54976 >> 20);
}

static void take_position(struct board *b, const uint8_t *data) {
    if (data[1] & (ALARM | WRONG_CRC)) return;
    b->good_ns = time_ns();
    b->ends = data[1] & (LIMIT_LOW | LIMIT_HIGH);
    b->position = i32(data + 2) & STEPS_MASK;
    b->latch_ns = b->good_ns - data[6] * INT32_C(4000) - b->settings[FRAME_NS];
}

static void motion_off(struct board *b) {
    b->mode = OFF;
    b->setpoint_q16 = b->wanted_q16 = b->rate = 0;
    b->selected = 0;
}

static void velocity_gains(struct board *b) {
    b->kp = b->p[LOCK] ? b->settings[b->blowing ? KP_GUST : KP_POINTING] : b->p[KP];
    b->ki = b->p[LOCK] ? b->settings[b->blowing ? KI_GUST : KI_CREEP] : b->p[KI];
}

static void motion_run(struct board *b, uint8_t mode, int32_t rate_q16) {
    b->mode = mode;
    if (mode == STOP) {
        b->kp = b->settings[KP_POINTING];
        b->ki = b->settings[KI_POINTING];
    } else {
        b->lock_q16 = 0;
        gusts_start(b);
        velocity_gains(b);
    }
    b->wanted_q16 = rate_q16;
    b->rate = 0;
}

static void enter_pointing(struct board *b) {
    int64_t relative, stop, here;
    if (pointing(b)) return;
    b->profile_rate = b->rate * INT64_C(4);
    here = measured(b, time_ns());
    relative = limited(b->setpoint_q16 * INT64_C(4) - b->profile_rate, INT64_C(3037000499)); /* its square fits */
    stop = quotient(relative * size_of(relative), 8 * (int64_t)b->p[ACCELERATION]);
    b->speed = relative;
    b->remaining = stop;
    b->target = here + stop;
    b->near_ticks = 0;
    b->blending = 0;
    gusts_start(b);
    b->kp = b->settings[KP_POINTING];
}

static void aim(struct board *b, int64_t position) {
    b->remaining += position - b->target;
    b->target = position;
}

static void track(struct board *b, int32_t rate_q16) {
    if (pointing(b)) {
        b->speed += (b->rate - (int64_t)rate_q16) * 4;
        b->profile_rate = rate_q16 * INT64_C(4);
        b->rate = rate_q16;
    } else {
        b->rate = rate_q16;
        enter_pointing(b);
    }
    if (!b->top) b->top = b->p[CLASSES + 1] * INT64_C(4);
    b->mode = MOVE;
}

static int64_t profile_step(struct board *b) {
    int64_t gap = size_of(b->remaining), a = b->p[ACCELERATION] * INT64_C(4), wanted = b->top;
    b->target += b->profile_rate;
    if (b->remaining || b->speed) {
        if (gap <= b->top * (b->top + a) / (2 * a)) wanted = root((a * a >> 2) + 2 * a * gap) - (a >> 1);
        if (wanted > gap) wanted = gap;
        if (b->remaining < 0) wanted = -wanted;
        b->speed += limited(wanted - b->speed, a);
        b->remaining -= b->speed;
    }
    return b->profile_rate + b->speed;
}

static int64_t point(struct board *b, int64_t now_ns) {
    int64_t feed = profile_step(b), here = measured(b, now_ns), error, held, correction;
    uint8_t creeping = size_of(feed) < b->settings[CREEP_RATE] * INT64_C(4);
    if (b->p[BLEND]) here = blend_step(b, here, creeping);
    error = b->target - b->remaining - here;
    held = limited(error, b->settings[LAG] * (int64_t)UNITS_PER_STEP);
    b->remaining += error - held; /* the axis cannot follow: the reference waits for it */
    correction = limited(held * b->settings[GAIN] >> 18, b->settings[CORRECTION]);
    if (size_of(held) < b->settings[SETTLE] * (int64_t)UNITS_PER_STEP && !b->remaining) {
        if (b->near_ticks < SETTLE_TICKS) b->near_ticks++;
        if (b->rate) b->mode = TRACK;
    } else {
        b->near_ticks = 0;
    }
    b->correction_q16 = (int32_t)correction;
    b->ki = b->settings[creeping ? KI_CREEP : KI_POINTING];
    if (b->p[LOCK]) {
        if (creeping && !b->remaining) gusts_step(b, (feed >> 2) + correction - b->velocity * (int64_t)Q16);
        b->kp = b->settings[creeping && b->blowing ? KP_GUST : KP_POINTING];
        if (creeping && b->blowing) b->ki = b->settings[KI_GUST];
    }
    return (feed >> 2) + correction;
}

static int64_t setpoint(struct board *b, int64_t now_ns) {
    if (b->mode == OFF) return 0;
    if (b->mode == OPEN_LOOP) b->setpoint_q16 = b->velocity * Q16;
    else if (pointing(b)) b->setpoint_q16 = (int32_t)point(b, now_ns);
    else if (b->setpoint_q16 != b->wanted_q16)
        b->setpoint_q16 += (int32_t)limited((int64_t)b->wanted_q16 - b->setpoint_q16, b->p[ACCELERATION]);
    else if (b->p[LOCK] && b->mode != STOP) {
        int64_t wanted = b->setpoint_q16 + lock_step(b, b->setpoint_q16);
        if (size_of(b->wanted_q16) < b->settings[CREEP_RATE]) {
            gusts_step(b, wanted - b->velocity * (int64_t)Q16);
            velocity_gains(b);
        }
        return wanted;
    }
    return b->setpoint_q16;
}

/* --- the observer: observer.py ----------------------------------------------------------------------------- */

static void observer_start(struct board *b) {
    for (uint8_t k = 0; k < 2 * SECTIONS; k++) b->states[k] = 0;
    b->owed_q16 = b->rate_q16 = 0;
    b->still = b->driving = 0;
}

static uint8_t observer_sound(const struct board *b) {
    int64_t gain = -(INT64_C(1) << 14);
    const int32_t *c = b->p + SECTION;
    for (uint8_t section = 0; section < SECTIONS; section++, c += 6) {
        int64_t rest = (INT64_C(1) << 28) - c[0] + c[1];
        if (size_of(c[1]) >= INT32_C(1) << 28 || size_of(c[0]) >= (INT64_C(1) << 28) + c[1]) return 0;
        gain += quotient(((int64_t)c[2] + c[3]) * 16384, rest);
    }
    return size_of(gain) <= 163;
}

static int64_t observer_aim(struct board *b, int64_t setpoint_q16) { /* the PI's set point */
    int64_t rate = 0;
    if (pointing(b)) rate = (b->profile_rate + b->speed) >> 2;
    else if (b->mode == RATE || b->mode == CLASS) rate = b->setpoint_q16;
    if (b->velocity < -1 || b->velocity > 1) b->still = 0;
    else if (b->still < STILL_TICKS) b->still++;
    if (size_of(rate) <= SLOWEST || size_of(rate) >= FASTEST) {
        b->driving = 0;
        return setpoint_q16;
    }
    b->held_q16 = (int32_t)(rate + (pointing(b) ? limited(b->correction_q16 >> 4, TRIM) : 0));
    if (!b->driving && b->still == STILL_TICKS) {
        b->driving = 1;
        b->rate_q16 = b->owed_q16 = 0;
    }
    return b->driving ? setpoint_q16 : 0;
}

static void observer_step(struct board *b) {
    const int32_t *c = b->p + SECTION;
    int32_t *state = b->states;
    if (b->driving) {
        b->rate_q16 += (int32_t)limited((int64_t)b->held_q16 - b->rate_q16, RAMP);
        b->owed_q16 = (int32_t)limited(b->owed_q16 + b->velocity * (int64_t)Q16 - b->rate_q16, OWED);
        b->driving = size_of(b->owed_q16) < OWED;
    }
    if (b->driving) {
        int64_t effort = (int64_t)b->p[THROUGH] * b->owed_q16 >> 24;
        for (uint8_t k = 0; k < SECTIONS; k++) effort += state[2 * k];
        b->effort_q16 = (int32_t)limited(effort, effort_limit(b));
    } else {
        b->owed_q16 = 0;
    }
    for (uint8_t section = 0; section < SECTIONS; section++, c += 6, state += 2) {
        int64_t first = state[0], u = b->effort_q16, owed = b->owed_q16;
        state[0] = (int32_t)limited(((c[0] * first + c[2] * u) >> 28) + state[1] + (c[4] * owed >> 24), INT32_TOP);
        state[1] = (int32_t)limited(((c[3] * u - c[1] * first) >> 28) + (c[5] * owed >> 24), INT32_TOP);
    }
}

/* --- soft limits: limits.py -------------------------------------------------------------------------------- */

static int64_t braking_steps(const struct board *b, int32_t velocity) {
    int64_t q16 = (int64_t)velocity * Q16 * velocity * Q16 / (2 * (int64_t)b->p[ACCELERATION]);
    q16 += size_of(velocity) * 30 * Q16; /* 150 ms until the loop follows */
    if (q16 > INT64_MAX >> 2) q16 = INT64_MAX >> 2;
    return q16 * 4 / UNITS_PER_STEP;
}

static uint8_t limit_hit(struct board *b) {
    int64_t braking;
    uint8_t outward;
    braking = pointing(b) ? 0 : braking_steps(b, b->velocity);
    outward = (b->velocity > 0 && b->position + braking >= b->p[HIGH])
              || (b->velocity < 0 && b->position - braking <= b->p[LOW])
              || (b->velocity > 0 && b->setpoint_q16 >= 0 && b->ends & LIMIT_HIGH)
              || (b->velocity < 0 && b->setpoint_q16 <= 0 && b->ends & LIMIT_LOW);
    b->reached = outward || b->ends || b->position > b->p[HIGH] || b->position < b->p[LOW];
    return outward && b->mode != OFF && b->mode != STOP;
}

static uint8_t inside(const struct board *b, int64_t steps) {
    return b->p[LOW] <= steps && steps <= b->p[HIGH];
}

/* --- modes: firmware.py ------------------------------------------------------------------------------------ */

static void close_loop(struct board *b) {
    if (b->fixed) pi_start(b, b->effort_command, b->setpoint_q16, b->velocity);
    b->fixed = 0;
}

static void fix_effort(struct board *b, int16_t effort) {
    b->fixed = 1;
    b->effort_command = effort;
}

static void stop(struct board *b) {
    if (b->mode == OFF) return;
    close_loop(b);
    motion_run(b, STOP, 0);
    b->selected = 0;
}

static void switch_motors(struct board *b, uint8_t on) {
    if (!on) {
        motion_off(b);
        fix_effort(b, 0);
    } else if (b->mode == OFF) {
        b->fault = 0;
        close_loop(b);
        motion_run(b, STOP, 0);
    }
}

/* --- parameters: commands.py, fineparameters.py ------------------------------------------------------------ */

static uint8_t bounds(uint8_t number, int32_t *low, int32_t *high) {
    static const int32_t highest[] = {25, GAIN_TOP, GAIN_TOP, STEPS_MASK, STEPS_MASK, 10276044, RATE_LIMIT,
        RATE_LIMIT, RATE_LIMIT, RATE_LIMIT, RATE_LIMIT, 1, 1, EFFORT_Q8, COUNTS_PER_TURN};
    uint8_t cell = (uint8_t)((number - LINES) % 3);
    if (number < SPLIT || number >= PARAMETERS) return 0;
    *low = number == SPLIT ? 10 : (number >= ACCELERATION && number < SPREAD) || number == TRAVEL;
    if (number < LINES) {
        *high = highest[number - 1];
    } else if (number > OBSERVER) {
        *high = INT32_TOP;
        *low = -INT32_TOP;
    } else if (number < BIAS) {
        *high = cell ? EFFORT_Q8 : INT32_TOP;
        *low = cell ? -EFFORT_Q8 : 0;
    } else {
        *high = number == BIAS ? EFFORT_Q8 / 10 : number == BLEND ? 15 : 1;
    }
    return 1;
}

static void book(struct board *b) {
    uint16_t extra = b->p[SPREAD] ? 75 : 0;
    if (b->p[BIAS]) extra = (uint16_t)(extra + 10);
    if (b->p[LOCK]) extra = (uint16_t)(extra + 140);
    if (b->p[BLEND]) extra = (uint16_t)(extra + 100);
    if (b->p[OBSERVER]) extra = (uint16_t)(extra + 900);
    if (b->p[COMPENSATION]) {
        for (uint8_t line = LINES; line < LINES + 3 * HARMONICS; line = (uint8_t)(line + 3))
            if (b->p[line + 1] || b->p[line + 2]) extra = (uint16_t)(extra + 120);
        extra = (uint16_t)(extra + 60);
    }
    book_cycles(firmware.timer.cost_cycles + (uint32_t)extra, b->p[SPREAD] ? 25 : 0);
}

static void changed(struct board *b, uint8_t number) {
    if (number == COMPENSATION) {
        b->friction_q16 = 0;
    } else if (number == TRAVEL) {
        b->reciprocal_q32 = (INT64_C(1) << 32) / b->p[TRAVEL];
    } else if (number == LOCK) {
        b->lock_q16 = 0;
        gusts_start(b);
        if (pointing(b)) b->kp = b->settings[KP_POINTING];
    } else if (number == BLEND) {
        b->blending = 0;
    } else if (number >= OBSERVER) {
        b->p[OBSERVER] = number == OBSERVER && b->p[OBSERVER] && observer_sound(b);
        observer_start(b);
    }
    if ((number == KP || number == KI || number == LOCK) && (b->mode == RATE || b->mode == CLASS))
        velocity_gains(b);
    if (number == SPREAD || number == COMPENSATION || number >= LINES) book(b);
}

/* --- commands: boards/core/commands.py, commands.py -------------------------------------------------------- */

static uint16_t health(const struct board *b) {
    int64_t now = time_ns();
    uint16_t bits = can_state() ? BUS : 0;
    bits |= lost_interrupts() ? OVERRUN : 0;
    bits |= now - b->dropped_ns < WARNING_NS ? DROPPED : 0;
    bits |= now - b->foreign_ns < WARNING_NS ? FOREIGN : 0;
    bits |= now - b->clipped_ns < WARNING_NS ? CLIPPED : 0;
    bits |= fresh(b) ? 0 : STALE;
    bits |= b->reached ? LIMIT : 0;
    return b->fault ? bits | FAULT_BIT | SENSOR : bits;
}

static uint8_t set_parameter(struct board *b, uint8_t number, int32_t value, int32_t *answer) {
    int32_t low, high;
    *answer = value;
    if (!bounds(number, &low, &high)) return OUT_OF_RANGE;
    if (value < low || value > high) {
        *answer = b->p[number];
        return OUT_OF_RANGE;
    }
    b->p[number] = value;
    changed(b, number);
    *answer = b->p[number];
    return OK;
}

static uint8_t run_at(struct board *b, uint8_t mode, int32_t rate, uint8_t class) {
    if (b->mode == OFF) return NOT_ALLOWED;
    close_loop(b);
    motion_run(b, mode, rate);
    b->selected = class;
    return OK;
}

static uint8_t move_to(struct board *b, uint32_t target, uint8_t class) {
    if (class < 1 || class > 5 || !inside(b, target)) return OUT_OF_RANGE;
    if (b->mode == OFF || !fresh(b)) return NOT_ALLOWED;
    close_loop(b);
    enter_pointing(b);
    b->top = b->p[CLASSES + class - 1] * INT64_C(4);
    aim(b, (int64_t)target * UNITS_PER_STEP);
    b->mode = MOVE;
    b->selected = class;
    return OK;
}

static uint8_t track_rate(struct board *b, int32_t rate) {
    if (size_of(rate) > b->p[CLASSES]) return OUT_OF_RANGE;
    if (b->mode == OFF || !fresh(b)) return NOT_ALLOWED;
    close_loop(b);
    track(b, rate);
    if (!b->selected) b->selected = 5;
    return OK;
}

static uint8_t open_loop(struct board *b, int16_t effort) {
    if (size_of(effort) > EFFORT_SCALE) return OUT_OF_RANGE;
    if (b->mode == OFF) return NOT_ALLOWED;
    fix_effort(b, (int16_t)quotient((int64_t)effort * b->settings[PWM_STEPS], EFFORT_SCALE));
    b->mode = OPEN_LOOP;
    b->rate = 0;
    return OK;
}

static uint8_t nudge(struct board *b, int32_t offset) {
    if (!pointing(b) || !fresh(b)) return NOT_ALLOWED;
    if (!inside(b, quotient(b->target, UNITS_PER_STEP) + offset)) return OUT_OF_RANGE;
    aim(b, b->target + (int64_t)offset * UNITS_PER_STEP);
    if (b->top < b->p[CLASSES + 2] * INT64_C(4)) b->top = b->p[CLASSES + 2] * INT64_C(4);
    b->mode = MOVE;
    return OK;
}

/* The result; the reply's parameter and value are filled in. */
static uint8_t serve(struct board *b, const uint8_t *data, uint8_t *parameter, int32_t *value) {
    int8_t direction = (int8_t)data[3];
    int32_t low, high;
    switch (data[1]) {
    case PING:
        *value = health(b);
        return OK;
    case GET_PARAMETER:
        *parameter = data[2];
        if (!bounds(data[2], &low, &high)) return OUT_OF_RANGE;
        *value = b->p[data[2]];
        return OK;
    case SET_PARAMETER:
        *parameter = data[2];
        return set_parameter(b, data[2], i32(data + 3), value);
    case POWER:
        if (data[2] > 1) return OUT_OF_RANGE;
        if (data[2] && !fresh(b)) return NOT_ALLOWED;
        switch_motors(b, data[2]);
        return OK;
    case STOP_NOW:
        stop(b);
        return OK;
    case SET_RATE:
        return size_of(i32(data + 2)) > RATE_LIMIT ? OUT_OF_RANGE : run_at(b, RATE, i32(data + 2), 0);
    case SET_CLASS:
        if (data[2] < 1 || data[2] > 5 || direction < -1 || direction > 1) return OUT_OF_RANGE;
        return run_at(b, CLASS, b->p[CLASSES + data[2] - 1] * direction, data[2]);
    case MOVE_TO: return move_to(b, (uint32_t)i32(data + 2), data[6]);
    case TRACK_RATE: return track_rate(b, i32(data + 2));
    case OPEN_LOOP_EFFORT: return open_loop(b, (int16_t)(data[2] | (uint16_t)data[3] << 8));
    case NUDGE: return nudge(b, i32(data + 2));
    default: return UNKNOWN_OPCODE;
    }
}

void board_can(struct board *b) {
    uint8_t *message = b->inbox[b->first], *data = message + 1, reply[8] = {b->device}, parameter = 0;
    int32_t value = 0;
    if (!b->waiting || b->late) return;
    b->first = (uint8_t)((b->first + 1) % INBOX);
    b->waiting--;
    reply[1] = message[0] > 1 ? data[1] : 0;
    if (message[0] != 8) reply[2] = WRONG_LENGTH;
    else if (data[0] != b->device) reply[2] = WRONG_DEVICE_TYPE;
    else reply[2] = serve(b, data, &parameter, &value);
    reply[3] = parameter;
    put(reply + 4, 4, (uint64_t)value);
    if (can_free() || can_state() == 2) {
        transmit(b, REPLY, reply);
    } else {
        b->late = 1;
        for (uint8_t k = 0; k < 8; k++) b->late_reply[k] = reply[k];
        can_notify();
    }
    if (b->waiting) request_can();
}

void board_sent(struct board *b) {
    reply_late(b);
}

void board_frame(struct board *b, const struct frame *frame) {
    uint8_t sender = frame->identifier & 0x7F, command = frame->identifier == (uint32_t)COMMAND + b->device;
    if (frame->extended) return;
    if (!command && (frame->length != 8 || frame->data[0] != sender || frame->remote)) {
        b->foreign_ns = time_ns();
    } else if (!command) {
        if (sender == b->settings[PEERS]) take_position(b, frame->data);
        else if (sender == b->settings[PEERS + 3]) auxiliary_take(b, frame->data);
        else tach_take(b, b->tach + (sender != b->settings[PEERS + 1]), frame->data);
    } else if (!frame->remote) {
        uint8_t *free = b->inbox[(b->first + b->waiting) % INBOX];
        if (b->waiting == INBOX) {
            drop(b);
            return;
        }
        *free++ = frame->length;
        for (uint8_t k = 0; k < frame->length; k++) *free++ = frame->data[k];
        b->waiting++;
        request_can();
    }
}

/* --- the routine: firmware.py, output.py ------------------------------------------------------------------- */

static int16_t drive_fine(struct board *b, int64_t setpoint_q16) { /* duties finer than a PWM step */
    int64_t effort = b->effort_q16, size, lag, bias = b->mode ? b->p[BIAS] * INT64_C(256) : 0;
    if (b->fixed) effort = (int64_t)b->effort_command * Q16;
    else if (b->p[COMPENSATION] && output_ns() - b->good_ns < STALE_NS)
        effort = limited(effort + compensation_q16(b, (int32_t)setpoint_q16), (int64_t)b->settings[PWM_STEPS] * Q16);
    size = size_of(effort);
    if (b->p[SPREAD]) {
        b->share_q16 += (int32_t)(share_of(b, size * b->p[SPLIT] / 100) - b->share_q16) >> SHARE_SHIFT;
        lag = b->share_q16;
    } else {
        size = (size + Q16 / 2) / Q16 * Q16;
        counter_follow(b, (int16_t)(size / Q16));
        lag = b->counter * (int64_t)Q16;
    }
    if (effort >= 0) write_pwm_q16((uint32_t)(size + bias), (uint32_t)(lag + bias));
    else write_pwm_q16((uint32_t)(lag + bias), (uint32_t)(size + bias));
    return steps_of(effort);
}

static uint16_t crc_after(uint16_t crc, const uint8_t *data, uint8_t bytes) {
    while (bytes--) {
        crc ^= (uint16_t)((uint16_t)*data++ << 8);
        for (uint8_t bit = 0; bit < 8; bit++) crc = (uint16_t)(crc & 0x8000 ? (crc << 1) ^ 0x1021 : crc << 1);
    }
    return crc;
}

static void sample(struct board *b, int16_t effort, const uint16_t *current, int64_t setpoint_q16) {
    int64_t now = time_ns();
    uint8_t *row = b->packet + 8, *end = row + SAMPLE_BYTES, *part = b->samples ? row : b->packet, cut = 0;
    if (!b->samples) {
        put(b->packet, 4, UINT32_C(0x55AA) | (uint32_t)b->device << 16 | (uint32_t)b->sequence << 24);
        put(b->packet + 4, 4, crystal_100us());
        b->clip_packet = 0;
        b->crc = crc_after(0xFFFF, b->packet + 2, 6);
    }
    put(row, 2, (uint64_t)effort);
    put(row + 2, 4, (uint64_t)(quotient(measured(b, now), UNITS_PER_STEP) & STEPS_MASK));
    put(row + 6, 2, (uint64_t)b->velocity);
    put(row + 8, 2, current[0]);
    put(row + 10, 2, current[1]);
    put(row + 12, 2, (uint64_t)fitted(tach_sample(b->tach, now), INT16_MIN, INT16_MAX, &cut));
    put(row + 14, 2, (uint64_t)fitted(tach_sample(b->tach + 1, now), INT16_MIN, INT16_MAX, &cut));
    put(row + 16, 4, (uint64_t)auxiliary_sample(b, now));
    put(row + 20, 4, (uint64_t)setpoint_q16);
    b->clip_packet |= cut;
    b->crc = crc_after(b->crc, row, SAMPLE_BYTES);
    if (++b->samples == SAMPLES) {
        if (b->clip_packet) clip(b);
        put(end, 2, b->crc);
        end += 2;
        b->sequence++;
        b->samples = 0;
    }
    uart_send(part, (uint16_t)(end - part), b->samples);
}

static void telemetry(struct board *b, int64_t setpoint_q16) { /* every 10 ms */
    uint8_t data[8], status, cut = 0, hit = limit_hit(b);
    uint16_t current[2];
    int16_t effort;
    int64_t velocity;
    if (hit || (pointing(b) && !fresh(b))) stop(b);
    status = (uint8_t)((b->mode ? b->mode | POWERED : 0) | (b->velocity ? MOVING : 0)
                       | (b->reached ? SOFT_LIMIT : 0) | (b->fault ? FAULTY : 0));
    effort = (int16_t)quotient((int64_t)b->effort * EFFORT_SCALE, b->settings[PWM_STEPS]);
    current[0] = read_current(0);
    current[1] = read_current(1);
    velocity = fitted(b->velocity, -0x4000, 0x3FFF, &cut);
    if (cut) clip(b);
    put(data, 8, b->device | (uint64_t)status << 8 | ((uint64_t)velocity & 0x7FFF) << 16
                 | ((uint64_t)effort & 0x1FFF) << 31 | (uint64_t)current[0] << 44 | (uint64_t)current[1] << 54);
    transmit(b, MEASUREMENT, data);
    sample(b, effort, current, b->mode == OPEN_LOOP ? NO_SETPOINT : setpoint_q16);
}

static void send_target(struct board *b) { /* every 250 ms */
    int64_t here = measured(b, time_ns()), distance = 0;
    uint8_t data[8] = {b->device, 0xF3};
    if (!fresh(b)) {
        b->watching = 0;
        b->watch_counts = 0;
    } else if (encoders_disagree(b, here) && b->mode != OFF) {
        b->fault = 1;
        motion_off(b);
        fix_effort(b, 0);
    }
    if (pointing(b)) distance = quotient(b->target - here, UNITS_PER_STEP);
    data[2] = (uint8_t)(b->selected | (pointing(b) && b->near_ticks >= SETTLE_TICKS ? 0x10 : 0));
    put(data + 3, 4, (uint64_t)distance);
    refresh(b, SUMMARY, data);
}

void board_timer(struct board *b) {
    uint16_t poscnt = read_encoder();
    int64_t wanted, aim;
    int16_t effort;
    b->ticks++;
    b->velocity = (int16_t)(poscnt - b->poscnt);
    b->poscnt = poscnt;
    b->watch_counts += b->velocity;
    wanted = setpoint(b, time_ns());
    aim = b->p[OBSERVER] ? observer_aim(b, wanted) : wanted;
    effort = b->fixed ? b->effort_command : pi_step(b, aim);
    if (b->p[OBSERVER]) {
        if (b->fixed) b->effort_q16 = effort * Q16;
        observer_step(b);
        effort = steps_of(b->effort_q16);
    }
    if (b->p[SPREAD] || b->p[COMPENSATION] || b->p[BIAS]) {
        effort = drive_fine(b, wanted);
    } else {
        counter_follow(b, effort);
        if (effort >= 0) write_pwm((uint16_t)effort, b->counter);
        else write_pwm(b->counter, (uint16_t)-effort);
    }
    b->effort = effort;
    if (!(b->ticks & 1)) telemetry(b, wanted);
    else if (b->ticks % 50 == 1) send_target(b);
    else if (b->ticks % 200 == 3) heartbeat(b, b->fault ? FAULT : b->mode ? ACTIVE : READY);
}

void board_init(struct board *b, uint8_t device, const int32_t *settings) {
    b->device = device;
    for (uint8_t k = 0; k < SETTINGS; k++) b->settings[k] = settings[k];
    for (uint8_t k = SPLIT; k < SPREAD; k++) /* the first settings are the parameters as programmed */
        b->p[k] = settings[k - 1];
    b->p[TRAVEL] = 1;
    b->kp = b->p[KP];
    b->ki = b->p[KI];
    can_filter(0, 0x7FF, (uint16_t)(COMMAND + device));
    for (uint8_t k = 0; k < 4; k++)
        if (settings[PEERS + k])
            can_filter((uint8_t)(2 + k), 0x7FF, (uint16_t)(MEASUREMENT + settings[PEERS + k]));
}

void board_reset(struct board *b) {
    b->foreign_ns = b->clipped_ns = b->dropped_ns = -WARNING_NS;
    b->waiting = b->late = 0;
    motion_off(b);
    b->good_ns = b->latch_ns = -STALE_NS;
    for (uint8_t k = 0; k < 2; k++) {
        b->tach[k].latch_ns = -2 * MISSING_NS;
        b->tach[k].known = 0;
        b->tach[k].rate_q8 = 0;
    }
    b->auxiliary_latch_ns = -2 * MISSING_NS;
    b->auxiliary_rate_q8 = 0;
    b->counter = 0;
    observer_start(b);
    b->share_q16 = 0;
    b->effort = 0;
    fix_effort(b, 0);
    b->velocity = 0;
    b->fault = 0;
    b->poscnt = read_encoder();
    b->ticks = 0;
    b->samples = 0;
}
