/* FMI 3.0 for co-simulation. */
#include "core.h"
#include "fmi/fmi3Functions.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    Core *core;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
    fmi3IntermediateUpdateCallback update;
    fmi3Boolean early_return_allowed;
} Instance;

#define EXPORT FMI3_Export
#define CATEGORY "logStatusError"

/* The status of what `core` returned, with its message in the log. */
static fmi3Status status_of(const Instance *instance, int failed) {
    if (!failed) return fmi3OK;
    if (instance->log)
        instance->log(instance->environment, fmi3Error, CATEGORY, instance->core->message);
    return fmi3Error;
}

#define FAILS(...) status_of(self, core_fails(self->core, __VA_ARGS__))
#define SELF                            \
    Instance *const self = instance;    \
    if (!self) return fmi3Error
#define MODE self->core->head->mode
#define REQUIRES(condition, function) \
    SELF;                             \
    if (!(condition)) return FAILS(function ": not allowed now")

EXPORT const char *fmi3GetVersion(void) { return fmi3Version; }

EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t n,
                                      const fmi3String categories[]) {
    (void)on, (void)n, (void)categories;   /* there are errors alone, which are always told */
    return instance ? fmi3OK : fmi3Error;
}

EXPORT fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logs,
    fmi3Boolean event_mode, fmi3Boolean early_return_allowed,
    const fmi3ValueReference intermediate[], size_t n_intermediate,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update) {
    (void)name, (void)resources, (void)visible, (void)logs, (void)intermediate;
    (void)n_intermediate;
    char message[MESSAGE_SIZE] = "out of memory";
    Instance *self = calloc(1, sizeof *self);
    if (event_mode) strcpy(message, "eventModeUsed: expected false: there is no event mode");
    else if (self) self->core = core_new(token, message);
    if (!self || !self->core) {
        if (log) log(environment, fmi3Error, CATEGORY, message);
        free(self);
        return NULL;
    }
    self->environment = environment;
    self->log = log;
    self->update = update;
    self->early_return_allowed = early_return_allowed;
    return self;
}

EXPORT void fmi3FreeInstance(fmi3Instance instance) {
    Instance *self = instance;
    if (!self) return;
    core_free(self->core);
    free(self);
}

EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean tolerance_defined,
                                              fmi3Float64 tolerance, fmi3Float64 start,
                                              fmi3Boolean stop_defined, fmi3Float64 stop) {
    REQUIRES(MODE == INSTANTIATED, "fmi3EnterInitializationMode");
    (void)tolerance_defined, (void)tolerance;
    return status_of(self, core_setup(self->core, start, stop_defined ? stop : INFINITY));
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
    REQUIRES(MODE == INITIALIZING, "fmi3ExitInitializationMode");
    return status_of(self, core_start(self->core));
}

EXPORT fmi3Status fmi3Terminate(fmi3Instance instance) {
    REQUIRES(MODE == STEPPING, "fmi3Terminate");
    self->core->head->mode = TERMINATED;
    return fmi3OK;
}

EXPORT fmi3Status fmi3Reset(fmi3Instance instance) {
    SELF;
    core_reset(self->core);
    return fmi3OK;
}

/* Variables, which are all scalar */

EXPORT fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[],
                                 size_t n, fmi3Float64 values[], size_t n_values) {
    REQUIRES(n == n_values, "fmi3GetFloat64: another number of values");
    for (size_t i = 0; i < n; i++)
        if (core_get(self->core, references[i], &values[i])) return status_of(self, 1);
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetInt64(fmi3Instance instance, const fmi3ValueReference references[],
                               size_t n, fmi3Int64 values[], size_t n_values) {
    REQUIRES(n == n_values, "fmi3GetInt64: another number of values");
    for (size_t i = 0; i < n; i++)
        if (core_get_integer(self->core, references[i], &values[i])) return status_of(self, 1);
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[],
                                 size_t n, const fmi3Float64 values[], size_t n_values) {
    REQUIRES(n == n_values && MODE != TERMINATED, "fmi3SetFloat64");
    for (size_t i = 0; i < n; i++)
        if (core_set(self->core, references[i], values[i])) return status_of(self, 1);
    return fmi3OK;
}

/* Steps */

/* Asks after an internal step whether the communication step ends early: the steps left of it. */
static int64_t steps_left(Instance *self, int64_t left) {
    Core *core = self->core;
    fmi3Boolean requested = fmi3False;
    fmi3Float64 until = core_time(core);
    core->head->mode = UPDATING;
    self->update(self->environment, core_time(core), fmi3True, fmi3True, fmi3True,
                 self->early_return_allowed, &requested, &until);
    if (core->head->mode == UPDATING) core->head->mode = STEPPING;
    if (!requested || !self->early_return_allowed) return left;
    const double more = floor((until - core_time(core)) / core_step_size(core) + 1e-3);
    return more < 0.0 ? 0 : more < (double)left ? (int64_t)more : left;
}

EXPORT fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 now, fmi3Float64 size,
                             fmi3Boolean no_way_back, fmi3Boolean *event, fmi3Boolean *terminate,
                             fmi3Boolean *early, fmi3Float64 *last) {
    REQUIRES(MODE == STEPPING, "fmi3DoStep");
    (void)no_way_back;
    Core *core = self->core;
    int64_t n = 0;
    *event = *terminate = *early = fmi3False;
    *last = core_time(core);
    if (core_count(core, now, size, &n)) return status_of(self, 1);
    while (n > 0) {
        if (core_step(core, n == 1 || self->update)) return status_of(self, 1);
        *last = core_time(core);
        n--;
        if (n == 0 || !self->update) continue;
        const int64_t left = steps_left(self, n);
        if (core->head->mode != STEPPING) return fmi3Error;   /* of what the callback has set */
        *early = *early || left < n;
        n = left;
    }
    return fmi3OK;
}

/* States */

EXPORT fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state) {
    SELF;
    return status_of(self, core_get_state(self->core, state));
}

EXPORT fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
    REQUIRES(state, "fmi3SetFMUState: no state");
    return status_of(self, core_set_state(self->core, state));
}

EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state) {
    if (state) {
        free(*state);
        *state = NULL;
    }
    return instance ? fmi3OK : fmi3Error;
}

EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state,
                                             size_t *size) {
    REQUIRES(state, "fmi3SerializedFMUStateSize: no state");
    *size = core_state_size(self->core);
    return fmi3OK;
}

EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state,
                                        fmi3Byte serialized[], size_t size) {
    REQUIRES(state && size >= core_state_size(self->core), "fmi3SerializeFMUState: too few bytes");
    memcpy(serialized, state, core_state_size(self->core));
    return fmi3OK;
}

EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte serialized[],
                                          size_t size, fmi3FMUState *state) {
    SELF;
    if (core_check_state(self->core, serialized, size)) return status_of(self, 1);
    if (!*state) *state = malloc(size);
    if (!*state) return FAILS("out of memory");
    memcpy(*state, serialized, size);
    return fmi3OK;
}

#include "fmi3_stubs.h"
