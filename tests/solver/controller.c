/* A controller of a joint as an FMU for co-simulation, of FMI 2 or 3 (-DFMI=2, 3).

   want = kp (reference - angle) - kd rate + ki z, within the limit;    z' = reference - angle
   torque' = (want - torque) / lag, exact over a step; without a lag torque = want */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#if FMI == 2
#include "fmi2Functions.h"
#define F(name) fmi2##name
typedef fmi2Component Self;
typedef fmi2Byte Byte;
typedef fmi2FMUstate Saved;
typedef fmi2Status Status;
#define EXPORT FMI2_Export
#define OK fmi2OK
#define FAILS fmi2Error
#else
#include "fmi3Functions.h"
#define F(name) fmi3##name
typedef fmi3Instance Self;
typedef fmi3Byte Byte;
typedef fmi3FMUState Saved;
typedef fmi3Status Status;
#define EXPORT FMI3_Export
#define OK fmi3OK
#define FAILS fmi3Error
#endif

enum { TIME, ANGLE, RATE, TORQUE, KP, KD, KI, LAG, LIMIT, REFERENCE, FAILS_AT, Z, COUNT, NUMBERS };

typedef struct {
    double x[NUMBERS];   /* by value references */
    int turns;
    void (*log)(void);
    void *environment;
} Model;

static void tell(Model *m, const char *message) {
#if FMI == 2
    fmi2CallbackLogger log = (fmi2CallbackLogger)m->log;
    if (log) log(m->environment, "controller", fmi2Error, "logStatusError", "%s", message);
#else
    fmi3LogMessageCallback log = (fmi3LogMessageCallback)m->log;
    if (log) log(m->environment, fmi3Error, "logStatusError", message);
#endif
}

static Model *model(void) {
    Model *m = calloc(1, sizeof *m);
    m->x[KP] = 50.0, m->x[KD] = 0.5, m->x[REFERENCE] = 1.0;
    m->x[LIMIT] = m->x[FAILS_AT] = 1e9;
    return m;
}

static double wanted(const Model *m) {
    const double *x = m->x;
    if (x[FAILS_AT] < 0.0) return NAN;
    double error = x[REFERENCE] - x[ANGLE];
    return fmax(fmin(x[KP] * error - x[KD] * x[RATE] + x[KI] * x[Z], x[LIMIT]), -x[LIMIT]);
}

static Status step(Model *m, double t, double h) {
    double *x = m->x;
    if (x[FAILS_AT] >= 0.0 && t + h > x[FAILS_AT]) {
        tell(m, "the drive is too hot");
        return FAILS;
    }
    x[Z] += h * (x[REFERENCE] - x[ANGLE]);
    double want = wanted(m);
    x[TORQUE] = x[LAG] > 0.0 ? want + (x[TORQUE] - want) * exp(-h / x[LAG]) : want;
    x[TIME] = t + h;
    x[COUNT] += 1.0;
    return OK;
}

EXPORT const char *F(GetVersion)(void) { return FMI == 2 ? "2.0" : "3.0"; }
EXPORT void F(FreeInstance)(Self self) { free(self); }
EXPORT Status F(Terminate)(Self self) { return self ? OK : FAILS; }

static Status ready(Model *m) {
    if (m->x[LAG] == 0.0) m->x[TORQUE] = wanted(m);
    return OK;
}

EXPORT Status F(ExitInitializationMode)(Self self) { return ready(self); }

static Status get(Model *m, const unsigned vr[], size_t n, double y[]) {
    for (size_t j = 0; j < n; j++) y[j] = m->x[vr[j]];
    return OK;
}

static Status set(Model *m, const unsigned vr[], size_t n, const double y[]) {
    for (size_t j = 0; j < n; j++) m->x[vr[j]] = y[j];
    return OK;
}

static Status derive(Model *m, const unsigned known[], size_t n, const double seed[], double *dy) {
    *dy = 0.0;
    for (size_t j = 0; j < n && m->x[LAG] == 0.0; j++)
        *dy -= seed[j] * m->x[known[j] == ANGLE ? KP : KD];
    return OK;
}

static Status save(Model *m, Saved *saved) {
    if (!*saved) *saved = malloc(sizeof *m);
    memcpy(*saved, m, sizeof *m);
    return OK;
}

static Status restore(Model *m, Saved saved) {
    memcpy(m->x, ((Model *)saved)->x, sizeof m->x);
    return OK;
}

static Status drop(Saved *saved) {
    free(*saved);
    *saved = NULL;
    return OK;
}

static Status serialize(Saved saved, Byte bytes[]) {
    memcpy(bytes, ((Model *)saved)->x, sizeof ((Model *)saved)->x);
    return OK;
}

static Status deserialize(const Byte bytes[], Saved *saved) {
    if (!*saved) *saved = calloc(1, sizeof(Model));
    memcpy(((Model *)*saved)->x, bytes, sizeof ((Model *)*saved)->x);
    return OK;
}

#if FMI == 2
EXPORT const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
EXPORT Self fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String place,
                            const fmi2CallbackFunctions *callbacks, fmi2Boolean v, fmi2Boolean l) {
    (void)name, (void)type, (void)token, (void)place, (void)v, (void)l;
    Model *m = model();
    m->log = (void (*)(void))callbacks->logger, m->environment = callbacks->componentEnvironment;
    return m;
}
EXPORT Status fmi2SetupExperiment(Self self, fmi2Boolean d, fmi2Real tolerance, fmi2Real t,
                                  fmi2Boolean e, fmi2Real stop) {
    (void)d, (void)tolerance, (void)e, (void)stop;
    ((Model *)self)->x[TIME] = t;
    return OK;
}
EXPORT Status fmi2EnterInitializationMode(Self self) { return self ? OK : FAILS; }
EXPORT Status fmi2GetReal(Self self, const unsigned vr[], size_t n, double y[]) {
    return get(self, vr, n, y);
}
EXPORT Status fmi2SetReal(Self self, const unsigned vr[], size_t n, const double y[]) {
    return set(self, vr, n, y);
}
EXPORT Status fmi2SetInteger(Self self, const unsigned vr[], size_t n, const int y[]) {
    (void)vr, (void)n;
    ((Model *)self)->turns = y[0];
    return OK;
}
EXPORT Status fmi2DoStep(Self self, fmi2Real t, fmi2Real h, fmi2Boolean c) {
    (void)c;
    return step(self, t, h);
}
EXPORT Status fmi2GetDirectionalDerivative(Self self, const unsigned y[], size_t m,
                                           const unsigned u[], size_t n, const double seed[],
                                           double dy[]) {
    (void)y, (void)m;
    return derive(self, u, n, seed, dy);
}
EXPORT Status fmi2GetFMUstate(Self self, Saved *s) { return save(self, s); }
EXPORT Status fmi2SetFMUstate(Self self, Saved s) { return restore(self, s); }
EXPORT Status fmi2FreeFMUstate(Self self, Saved *s) { (void)self; return drop(s); }
EXPORT Status fmi2SerializedFMUstateSize(Self self, Saved s, size_t *n) {
    (void)s;
    *n = sizeof ((Model *)self)->x;
    return OK;
}
EXPORT Status fmi2SerializeFMUstate(Self self, Saved s, Byte bytes[], size_t n) {
    (void)self, (void)n;
    return serialize(s, bytes);
}
EXPORT Status fmi2DeSerializeFMUstate(Self self, const Byte bytes[], size_t n, Saved *s) {
    (void)self, (void)n;
    return deserialize(bytes, s);
}
#else
EXPORT Self fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String place, fmi3Boolean v, fmi3Boolean l,
    fmi3Boolean ev, fmi3Boolean er, const fmi3ValueReference r[], size_t n,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update) {
    (void)name, (void)token, (void)place, (void)v, (void)l, (void)ev, (void)er, (void)r, (void)n;
    (void)update;
    Model *m = model();
    m->log = (void (*)(void))log, m->environment = environment;
    return m;
}
EXPORT Status fmi3EnterInitializationMode(Self self, fmi3Boolean d, fmi3Float64 tolerance,
                                          fmi3Float64 t, fmi3Boolean e, fmi3Float64 stop) {
    (void)d, (void)tolerance, (void)e, (void)stop;
    ((Model *)self)->x[TIME] = t;
    return OK;
}
EXPORT Status fmi3GetFloat64(Self self, const unsigned vr[], size_t n, double y[], size_t k) {
    (void)k;
    return get(self, vr, n, y);
}
EXPORT Status fmi3SetFloat64(Self self, const unsigned vr[], size_t n, const double y[], size_t k) {
    (void)k;
    return set(self, vr, n, y);
}
EXPORT Status fmi3SetInt32(Self self, const unsigned vr[], size_t n, const int y[], size_t k) {
    (void)vr, (void)n, (void)k;
    ((Model *)self)->turns = y[0];
    return OK;
}
EXPORT Status fmi3DoStep(Self self, fmi3Float64 t, fmi3Float64 h, fmi3Boolean c, fmi3Boolean *event,
                         fmi3Boolean *ends, fmi3Boolean *early, fmi3Float64 *last) {
    (void)c;
    *event = *ends = *early = fmi3False;
    *last = t + h;
    return step(self, t, h);
}
EXPORT Status fmi3GetDirectionalDerivative(Self self, const unsigned y[], size_t m,
                                           const unsigned u[], size_t n, const double seed[],
                                           size_t k, double dy[], size_t l) {
    (void)y, (void)m, (void)k, (void)l;
    return derive(self, u, n, seed, dy);
}
EXPORT Status fmi3GetFMUState(Self self, Saved *s) { return save(self, s); }
EXPORT Status fmi3SetFMUState(Self self, Saved s) { return restore(self, s); }
EXPORT Status fmi3FreeFMUState(Self self, Saved *s) { (void)self; return drop(s); }
EXPORT Status fmi3SerializedFMUStateSize(Self self, Saved s, size_t *n) {
    (void)s;
    *n = sizeof ((Model *)self)->x;
    return OK;
}
EXPORT Status fmi3SerializeFMUState(Self self, Saved s, Byte bytes[], size_t n) {
    (void)self, (void)n;
    return serialize(s, bytes);
}
EXPORT Status fmi3DeserializeFMUState(Self self, const Byte bytes[], size_t n, Saved *s) {
    (void)self, (void)n;
    return deserialize(bytes, s);
}
#endif
