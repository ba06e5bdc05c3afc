/* The FMI functions around the kernel of one axis: FMI 3.0, or 2.0 with -DFMI=2 (fmi-standard.org).
   Memory of an instance is one flat block, so that its state is a copy. model.h is written by tables.py. */
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "model.h"

#define EXPORT __attribute__((visibility("default")))
enum { OK, WARNING, DISCARD, ERROR };
enum { TIME, DUTY_A, DUTY_B, REALS = 10, COUNTERS = 20, SWITCHES = 50, PARAMETERS = 1000 }; /* references */

/* numba's convention: result, error, the array (two owners, items, bytes of one, data, shape, stride), rest */
extern int kernel_prepare(void **, void **, void *, void *, int64_t, int64_t, double *, int64_t, int64_t, void *,
                          void *, int64_t, int64_t, double *, int64_t, int64_t);
extern int kernel_advance(void **, void **, void *, void *, int64_t, int64_t, double *, int64_t, int64_t, int64_t);

typedef struct {
    double w[AT_WIDTH], p[N_PARAMETERS], duty[2];
    int64_t grid, point, now, late[N_COLUMNS]; /* ns; point: the grid point of the state */
    double start;
    bool on[N_EFFECTS + 1], ready, running;
} State;

typedef struct {
    State s;
    char name[64];
    void *environment;
    void (*log)();
} Axis;

static void tell(Axis *a, const char *text, const char *what)
{
    char line[200];
    snprintf(line, sizeof line, "%s: %s%s", a->name, text, what);
    if (a->log)
#if FMI == 2
        ((void (*)(void *, const char *, int, const char *, const char *, ...))a->log)(a->environment, a->name,
                                                                                      ERROR, "error", "%s", line);
#else
        ((void (*)(void *, int, const char *, const char *))a->log)(a->environment, ERROR, "error", line);
#endif
}

static void advance(State *s, int64_t steps)
{
    void *result, *error;
    kernel_advance(&result, &error, 0, 0, AT_WIDTH, 8, s->w, AT_WIDTH, 8, steps);
}

/* The row of the world, as plant/world.py and plant/rows.py make it. */
static bool begin(Axis *a)
{
    State *s = &a->s;
    void *result, *error;
    double n[N_NUMBERS];
    int rows = 0, motor_rows = 0;
    memset(s->w, 0, sizeof s->w);
    memset(s->late, 0, sizeof s->late);
    memcpy(n, s->p, sizeof n);
    for (int k = 0; k < N_CHANGES; k++)
        if (s->on[CHANGES[k].effect])
            n[CHANGES[k].number] += s->p[CHANGES[k].parameter];
    kernel_prepare(&result, &error, 0, 0, AT_WIDTH, 8, s->w, AT_WIDTH, 8, 0, 0, N_NUMBERS, 8, n, N_NUMBERS, 8);
    if (!(s->w[AT_INERTIA] > 0.0))
        return tell(a, "more swings than the axis' inertia", ""), false;
    s->grid = llrint(n[GRID] * 1e9);
    for (int k = 0; k < N_ROWS; k++) {
        if (!s->on[ROWS[k].effect])
            continue;
        double *row = s->w + AT_EFFECTS + AT_ROW * rows++;
        memcpy(row, ROW_START[k], sizeof ROW_START[k]);
        motor_rows += ROWS[k].of_motors;
        for (int f = ROWS[k].first; f < ROWS[k].end; f++)
            row[FILLS[f].place] = FILLS[f].constant ? s->w[FILLS[f].from] : s->p[FILLS[f].from];
    }
    s->w[AT_ROWS_MOTOR] = motor_rows;
    s->w[AT_ROWS_ALL] = rows;
    for (int k = 0; k < N_DELAYS; k++)
        if (s->on[DELAYS[k].effect]) {
            int64_t *late = &s->late[(int)s->p[DELAYS[k].column]];
            *late += llrint(s->p[DELAYS[k].delay] * 1e9);
            if (*late > (AT_DELAY_ROWS - 2) * s->grid)
                return tell(a, "channel_delay is beyond the memory of readings", ""), false;
            s->w[AT_DELAY_ON] = s->w[AT_DELAY_ON] || *late > 0;
        }
    advance(s, 0);
    s->point = s->now = 0;
    return s->ready = true;
}

static double now_or_late(const State *s, int reading, int column, bool slope)
{
    int64_t ago = s->now - s->late[column], since = s->now - s->point;
    const double *row = s->w + AT_OUT;
    if (s->late[column]) {
        int64_t step = ago > 0 ? ago / s->grid : 0;
        since = ago > step * s->grid ? ago - step * s->grid : 0;
        row = s->w + AT_DELAYS + step % AT_DELAY_ROWS * AT_OUT_SIZE;
    }
    return slope ? row[reading] + row[reading + 1] * (double)since : row[reading];
}

static int64_t counter(const State *s, int k)
{
    double count = floor(now_or_late(s, COUNTER[k].reading, COUNTER[k].column, true));
    int64_t mask = COUNTER[k].bits < 0 ? -1 : ((int64_t)1 << (int)s->p[COUNTER[k].bits]) - 1;
    return (int64_t)count & mask;
}

static double real(const State *s, int k)
{
    const double *w = s->w;
    switch (k) {
    case 0: case 1: return now_or_late(s, AT_OUT_CURRENT_A + k, CURRENTS, false);
    case 2: return w[AT_OUT + AT_OUT_ANGLE] + w[AT_OUT + AT_OUT_ANGLE + 1] * (double)(s->now - s->point);
    case 3: return w[AT_RATE];
    case 4: return w[AT_MOTORS + AT_M_GEAR] + w[AT_MOTORS + AT_MOTOR_SIZE + AT_M_GEAR];
    default: return w[AT_FRICTION];
    }
}

static int get_real(Axis *a, uint32_t r, double *v)
{
    State *s = &a->s;
    if (!s->ready && !begin(a))
        return ERROR;
    if (r == TIME) *v = s->start + (double)s->now * 1e-9;
    else if (r == DUTY_A || r == DUTY_B) *v = s->duty[r - DUTY_A];
    else if (r >= REALS && r < REALS + N_REALS) *v = real(s, (int)r - REALS);
    else if (r >= PARAMETERS && r < PARAMETERS + N_PARAMETERS) *v = s->p[r - PARAMETERS];
    else return tell(a, "no real number has this reference", ""), ERROR;
    return OK;
}

static int set_real(Axis *a, uint32_t r, const double *v)
{
    State *s = &a->s;
    if (r == DUTY_A || r == DUTY_B) {
        if (!(*v >= 0.0 && *v <= 1.0))
            return tell(a, "duty cycles must lie within 0..1", ""), ERROR;
        s->duty[r - DUTY_A] = *v;
        return OK;
    }
    if (r < PARAMETERS || r >= PARAMETERS + N_PARAMETERS || s->running)
        return tell(a, s->running ? "parameters are fixed once it runs" : "no such parameter", ""), ERROR;
    if (!(*v >= LOW[r - PARAMETERS] && *v <= HIGH[r - PARAMETERS]))
        return tell(a, "out of its bounds: ", NAMES[r - PARAMETERS]), ERROR;
    s->p[r - PARAMETERS] = *v;
    s->ready = false;
    return OK;
}

static int get_count(Axis *a, uint32_t r, int64_t *v)
{
    if (r < COUNTERS || r >= COUNTERS + N_COUNTERS || (!a->s.ready && !begin(a)))
        return tell(a, "no counter has this reference", ""), ERROR;
    *v = counter(&a->s, (int)r - COUNTERS);
    return OK;
}

static int switched(Axis *a, uint32_t r, bool **on, bool write)
{
    if (r < SWITCHES || r >= SWITCHES + N_EFFECTS || (write && a->s.running))
        return tell(a, "no effect can be switched here", ""), ERROR;
    *on = &a->s.on[r - SWITCHES];
    a->s.ready = a->s.ready && !write;
    return OK;
}

static int step(Axis *a, double from, double length)
{
    State *s = &a->s;
    int64_t end = llrint((from + length - s->start) * 1e9);
    if (!s->ready && !begin(a))
        return ERROR;
    if (llrint((from - s->start) * 1e9) != s->now || end < s->now)
        return tell(a, "a step begins where the last one ended", ""), ERROR;
    s->running = true;
    double rest = (double)(s->point + s->grid - s->now) / (double)s->grid; /* duties count for the rest of it */
    for (int m = 0; m < 2; m++)
        s->w[AT_MEAN_DUTY + m] += (s->duty[m] - s->w[AT_DUTY + m]) * rest, s->w[AT_DUTY + m] = s->duty[m];
    if (end - s->point >= s->grid) {
        int64_t steps = (end - s->point) / s->grid;
        advance(s, steps);
        s->point += steps * s->grid;
    }
    s->now = end;
    return OK;
}

static void reset(State *s)
{
    memset(s, 0, sizeof *s);
    memcpy(s->p, START, sizeof s->p);
    memcpy(s->on, ENABLED, sizeof s->on);
}

static Axis *make(const char *name, const char *token, void *environment, void (*log)())
{
    Axis *a = calloc(1, sizeof *a);
    if (!a) return 0;
    snprintf(a->name, sizeof a->name, "%s", name ? name : "");
    a->environment = environment;
    a->log = log;
    reset(&a->s);
    if (token && strcmp(token, TOKEN) == 0)
        return a;
    tell(a, "this is another model's token", "");
    free(a);
    return 0;
}

#define EACH(action) for (size_t k = 0; k < n; k++) { int said = (action); if (said) return said; } return OK
#define NONE(name) EXPORT int name(void) { return ERROR; }

#if FMI == 2
typedef int Flag;
typedef struct { void (*log)(); void *alloc, *release, *finished, *environment; } Callbacks;
#define F(name) fmi2##name
#define REAL(verb) fmi2##verb##Real
#define STATE(verb) fmi2##verb##FMUstate
#define SIZE fmi2SerializedFMUstateSize
#define LOADS fmi2DeSerializeFMUstate
#define ARRAY(type) const uint32_t *r, size_t n, type *v
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
EXPORT void *fmi2Instantiate(const char *name, int kind, const char *token, const char *place, const Callbacks *c,
                             int visible, int logging)
{ return kind == 1 ? make(name, token, c->environment, c->log) : 0; }
EXPORT int fmi2SetupExperiment(Axis *a, int has, double tolerance, double start, int ends, double end)
{ return a->s.start = start, OK; }
EXPORT int fmi2EnterInitializationMode(Axis *a) { return OK; }
static int get_int(Axis *a, uint32_t r, int *v)
{
    int64_t count = 0;
    int said = get_count(a, r, &count);
    *v = (int)count;
    return said || *v != count ? ERROR : OK; /* FMI 2 has no more than 32 bits */
}
EXPORT int fmi2GetInteger(Axis *a, ARRAY(int)) { EACH(get_int(a, r[k], v + k)); }
EXPORT int fmi2DoStep(Axis *a, double from, double length, int final) { return step(a, from, length); }
EXPORT int fmi2GetBooleanStatus(Axis *a, int kind, int *v) { return *v = 0, OK; }
EXPORT int fmi2GetRealStatus(Axis *a, int kind, double *v)
{ return *v = a->s.start + (double)a->s.now * 1e-9, OK; }
NONE(fmi2SetInteger) NONE(fmi2GetString) NONE(fmi2SetString) NONE(fmi2GetDirectionalDerivative)
NONE(fmi2SetRealInputDerivatives) NONE(fmi2GetRealOutputDerivatives) NONE(fmi2CancelStep) NONE(fmi2GetStatus)
NONE(fmi2GetIntegerStatus) NONE(fmi2GetStringStatus)
#else
typedef bool Flag;
#define F(name) fmi3##name
#define REAL(verb) fmi3##verb##Float64
#define STATE(verb) fmi3##verb##FMUState
#define SIZE fmi3SerializedFMUStateSize
#define LOADS fmi3DeserializeFMUState
#define ARRAY(type) const uint32_t *r, size_t n, type *v, size_t m
EXPORT const char *fmi3GetVersion(void) { return "3.0"; }
EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *place, bool visible,
                                         bool logging, bool events, bool early, const uint32_t *wanted, size_t n,
                                         void *environment, void (*log)(), void (*update)())
{ return make(name, token, environment, log); }
EXPORT void *fmi3InstantiateModelExchange(void) { return 0; }
EXPORT void *fmi3InstantiateScheduledExecution(void) { return 0; }
EXPORT int fmi3EnterInitializationMode(Axis *a, bool has, double tolerance, double start, bool ends, double end)
{ return a->s.start = start, OK; }
EXPORT int fmi3GetInt64(Axis *a, ARRAY(int64_t)) { EACH(get_count(a, r[k], v + k)); }
EXPORT int fmi3DoStep(Axis *a, double from, double length, bool final, bool *events, bool *ends, bool *early,
                      double *reached)
{
    int said = step(a, from, length);
    *events = *ends = *early = false;
    *reached = a->s.start + (double)a->s.now * 1e-9;
    return said;
}
#define BOTH(type) NONE(fmi3Get##type) NONE(fmi3Set##type)
#define OTHER(type) NONE(fmi3Set##type)
BOTH(Float32) BOTH(Int8) BOTH(UInt8) BOTH(Int16) BOTH(UInt16) BOTH(Int32) BOTH(UInt32) BOTH(UInt64) BOTH(String)
BOTH(Binary) BOTH(Clock) BOTH(IntervalDecimal) BOTH(IntervalFraction) BOTH(ShiftDecimal) BOTH(ShiftFraction)
OTHER(Int64) NONE(fmi3EnterEventMode) NONE(fmi3GetNumberOfVariableDependencies) NONE(fmi3GetVariableDependencies)
NONE(fmi3GetDirectionalDerivative) NONE(fmi3GetAdjointDerivative) NONE(fmi3EnterConfigurationMode)
NONE(fmi3ExitConfigurationMode) NONE(fmi3EvaluateDiscreteStates) NONE(fmi3UpdateDiscreteStates)
NONE(fmi3EnterContinuousTimeMode) NONE(fmi3CompletedIntegratorStep) OTHER(Time) OTHER(ContinuousStates)
NONE(fmi3GetContinuousStateDerivatives) NONE(fmi3GetEventIndicators) NONE(fmi3GetContinuousStates)
NONE(fmi3GetNominalsOfContinuousStates) NONE(fmi3GetNumberOfEventIndicators) NONE(fmi3GetNumberOfContinuousStates)
NONE(fmi3EnterStepMode) NONE(fmi3GetOutputDerivatives) NONE(fmi3ActivateModelPartition)
#endif

EXPORT void F(FreeInstance)(Axis *a) { free(a); }
EXPORT int F(SetDebugLogging)(Axis *a, Flag on, size_t n, const char *const *categories) { return OK; }
EXPORT int F(ExitInitializationMode)(Axis *a) { return a->s.ready || begin(a) ? OK : ERROR; }
EXPORT int F(Terminate)(Axis *a) { return OK; }
EXPORT int F(Reset)(Axis *a) { return reset(&a->s), OK; }
EXPORT int REAL(Get)(Axis *a, ARRAY(double)) { EACH(get_real(a, r[k], v + k)); }
EXPORT int REAL(Set)(Axis *a, ARRAY(const double)) { EACH(set_real(a, r[k], v + k)); }
EXPORT int F(GetBoolean)(Axis *a, ARRAY(Flag))
{ bool *on = 0; EACH(switched(a, r[k], &on, false) ? ERROR : (v[k] = *on, OK)); }
EXPORT int F(SetBoolean)(Axis *a, ARRAY(const Flag))
{ bool *on = 0; EACH(switched(a, r[k], &on, true) ? ERROR : (*on = v[k] != 0, OK)); }
EXPORT int STATE(Get)(Axis *a, void **state)
{ return *state || (*state = malloc(sizeof(State))) ? memcpy(*state, &a->s, sizeof(State)), OK : ERROR; }
EXPORT int STATE(Set)(Axis *a, void *state) { return memcpy(&a->s, state, sizeof(State)), OK; }
EXPORT int STATE(Free)(Axis *a, void **state) { return free(*state), *state = 0, OK; }
EXPORT int SIZE(Axis *a, void *state, size_t *size) { return *size = sizeof(State), OK; }
EXPORT int STATE(Serialize)(Axis *a, void *state, char *bytes, size_t size)
{ return size < sizeof(State) ? ERROR : (memcpy(bytes, state, sizeof(State)), OK); }
EXPORT int LOADS(Axis *a, const char *bytes, size_t size, void **state)
{
    if (size != sizeof(State) || !(*state = malloc(sizeof(State)))) return ERROR;
    return memcpy(*state, bytes, sizeof(State)), OK;
}
