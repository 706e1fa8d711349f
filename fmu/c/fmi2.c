/* FMI 2.0 for co-simulation. */
#include "core.h"
#include "fmi/fmi2Functions.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    Core *core;
    fmi2CallbackFunctions callbacks;
    char name[256];
} Instance;

#define EXPORT FMI2_Export

/* The message is the format: some importers show that alone. */
static void tell(const fmi2CallbackFunctions *callbacks, const char *name, const char *message) {
    char format[2 * MESSAGE_SIZE];
    size_t n = 0;
    for (; *message; message++) {
        if (*message == '%') format[n++] = '%';
        format[n++] = *message;
    }
    format[n] = 0;
    if (callbacks && callbacks->logger)
        callbacks->logger(callbacks->componentEnvironment, name, fmi2Error, "logStatusError",
                          format);
}

/* The status of what `core` returned, with its message in the log. */
static fmi2Status status_of(const Instance *self, int failed) {
    if (failed) tell(&self->callbacks, self->name, self->core->message);
    return failed ? fmi2Error : fmi2OK;
}

#define FAILS(...) status_of(self, core_fails(self->core, __VA_ARGS__))
#define SELF                            \
    Instance *const self = component;   \
    if (!self) return fmi2Error
#define MODE self->core->head->mode
#define REQUIRES(condition, function) \
    SELF;                             \
    if (!(condition)) return FAILS(function ": not allowed now")

EXPORT const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
EXPORT const char *fmi2GetVersion(void) { return fmi2Version; }

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t n,
                                      const fmi2String categories[]) {
    (void)on, (void)n, (void)categories;   /* there are errors alone, which are always told */
    return component ? fmi2OK : fmi2Error;
}

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token,
                                     fmi2String resources, const fmi2CallbackFunctions *callbacks,
                                     fmi2Boolean visible, fmi2Boolean logs) {
    (void)resources, (void)visible, (void)logs;
    char message[MESSAGE_SIZE] = "out of memory";
    Instance *self = calloc(1, sizeof *self);
    if (type != fmi2CoSimulation) strcpy(message, "fmuType: expected fmi2CoSimulation");
    else if (self) self->core = core_new(token, message);
    if (!self || !self->core) {
        tell(callbacks, name, message);
        free(self);
        return NULL;
    }
    if (callbacks) self->callbacks = *callbacks;
    snprintf(self->name, sizeof self->name, "%s", name ? name : "");
    return self;
}

EXPORT void fmi2FreeInstance(fmi2Component component) {
    Instance *self = component;
    if (!self) return;
    core_free(self->core);
    free(self);
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean tolerance_defined,
                                      fmi2Real tolerance, fmi2Real start, fmi2Boolean stop_defined,
                                      fmi2Real stop) {
    REQUIRES(MODE == INSTANTIATED, "fmi2SetupExperiment");
    (void)tolerance_defined, (void)tolerance;
    const int failed = core_setup(self->core, start, stop_defined ? stop : INFINITY);
    if (!failed) self->core->head->mode = INSTANTIATED;
    return status_of(self, failed);
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
    REQUIRES(MODE == INSTANTIATED, "fmi2EnterInitializationMode");
    self->core->head->mode = INITIALIZING;
    return fmi2OK;
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
    REQUIRES(MODE == INITIALIZING, "fmi2ExitInitializationMode");
    return status_of(self, core_start(self->core));
}

EXPORT fmi2Status fmi2Terminate(fmi2Component component) {
    REQUIRES(MODE == STEPPING, "fmi2Terminate");
    self->core->head->mode = TERMINATED;
    return fmi2OK;
}

EXPORT fmi2Status fmi2Reset(fmi2Component component) {
    SELF;
    core_reset(self->core);
    return fmi2OK;
}

/* Variables */

EXPORT fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[],
                              size_t n, fmi2Real values[]) {
    SELF;
    for (size_t i = 0; i < n; i++)
        if (core_get(self->core, references[i], &values[i])) return status_of(self, 1);
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference references[],
                                 size_t n, fmi2Integer values[]) {
    SELF;
    for (size_t i = 0; i < n; i++) {
        int64_t value = 0;
        if (core_get_integer(self->core, references[i], &value)) return status_of(self, 1);
        values[i] = (fmi2Integer)value;
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[],
                              size_t n, const fmi2Real values[]) {
    REQUIRES(MODE != TERMINATED, "fmi2SetReal");
    for (size_t i = 0; i < n; i++)
        if (core_set(self->core, references[i], values[i])) return status_of(self, 1);
    return fmi2OK;
}

/* Steps */

EXPORT fmi2Status fmi2DoStep(fmi2Component component, fmi2Real now, fmi2Real size,
                             fmi2Boolean no_way_back) {
    REQUIRES(MODE == STEPPING, "fmi2DoStep");
    (void)no_way_back;
    int64_t n = 0;
    int failed = core_count(self->core, now, size, &n);
    for (; n > 0 && !failed; n--) failed = core_step(self->core, n == 1);
    return status_of(self, failed);
}

EXPORT fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind,
                                    fmi2Real *value) {
    REQUIRES(kind == fmi2LastSuccessfulTime, "fmi2GetRealStatus");
    *value = core_time(self->core);
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind,
                                       fmi2Boolean *value) {
    REQUIRES(kind == fmi2Terminated, "fmi2GetBooleanStatus");
    *value = fmi2False;
    return fmi2OK;
}

/* States */

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state) {
    SELF;
    return status_of(self, core_get_state(self->core, state));
}

EXPORT fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
    REQUIRES(state, "fmi2SetFMUstate: no state");
    return status_of(self, core_set_state(self->core, state));
}

EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state) {
    if (state) {
        free(*state);
        *state = NULL;
    }
    return component ? fmi2OK : fmi2Error;
}

EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state,
                                             size_t *size) {
    REQUIRES(state, "fmi2SerializedFMUstateSize: no state");
    *size = core_state_size(self->core);
    return fmi2OK;
}

EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state,
                                        fmi2Byte serialized[], size_t size) {
    REQUIRES(state && size >= core_state_size(self->core), "fmi2SerializeFMUstate: too few bytes");
    memcpy(serialized, state, core_state_size(self->core));
    return fmi2OK;
}

EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte serialized[],
                                          size_t size, fmi2FMUstate *state) {
    SELF;
    if (core_check_state(self->core, serialized, size)) return status_of(self, 1);
    if (!*state) *state = malloc(size);
    if (!*state) return FAILS("out of memory");
    memcpy(*state, serialized, size);
    return fmi2OK;
}

#include "fmi2_stubs.h"
