#include "core.h"
#include "image.h"
#include "processor.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The compiled time loop: results, then addresses and numbers as words. */
void duhamel_solver_step_loop_advance(double *results, void *run, void *inputs);
void duhamel_solver_step_loop_is_contact_near(double *results, void *system, double h, void *state,
                                              void *work);
void duhamel_solver_step_sizes_change_size(double *results, void *old, void *new, void *state,
                                           void *work);
void duhamel_solver_step_record_record(double *results, void *run, int64_t row);
void duhamel_solver_step_watches_wrong_branch(double *results, void *couplings, const void *rows,
                                              int64_t n, void *work);
void duhamel_solver_step_watches_open_row(double *results, void *rows, const void *removed,
                                          int64_t n, const void *limits, int64_t n_limits,
                                          double *gradient, int64_t n_gradient, void *work);

/* Of image.c, which is made for each export. */
extern const unsigned char duhamel_image[];
extern const int duhamel_processor;

enum { CONSTANT_SEGMENT, LIVE_SEGMENT, ALIGNMENT = 64, STEPS_BETWEEN_CHECKS = 256 };
static const double STEP_ROUNDING = 1e-3;   /* of times and sizes that importers give, in steps */

static const void *piece(const Core *core, int k) {
    return (const unsigned char *)core->image + core->image[HEADER_PIECES + 2 * k];
}

static int64_t bytes(const Core *core, int k) { return core->image[HEADER_PIECES + 2 * k + 1]; }

static int64_t words(const Core *core, int k) { return bytes(core, k) / 8; }

static int64_t number(const Core *core, int k) {
    return core->image[HEADER_PIECES + 2 * N_PIECES + k];
}

static double real(const Core *core, int k) {
    int64_t word = number(core, k);
    double value;
    memcpy(&value, &word, sizeof value);
    return value;
}

static void *live(const Core *core, int k) { return core->live + number(core, k); }

static void *record(const Core *core, int k) { return core->words + number(core, k); }

static const char *name(const Core *core, int table, int64_t i) {
    return (const char *)piece(core, PIECE_TEXTS) + ((const int64_t *)piece(core, table))[i];
}

static size_t rounded(size_t n) { return (n + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT; }

static void *aligned(void *memory) { return (void *)rounded((uintptr_t)memory); }

/* An instance */

Core *core_new(const char *token, char message[MESSAGE_SIZE]) {
    Core *core = calloc(1, sizeof *core);
    if (!core) {
        snprintf(message, MESSAGE_SIZE, "out of memory");
        return NULL;
    }
    core->image = (const int64_t *)(const void *)duhamel_image;
    const unsigned char *digest = (const unsigned char *)(core->image + HEADER_DIGEST);
    for (int i = 0; i < 32; i++) snprintf(core->token + 2 * i, 3, "%02x", digest[i]);
    if (!token || strcmp(token, core->token)) {
        snprintf(message, MESSAGE_SIZE, "expected the token %s of this export, got %s", core->token,
                 token ? token : "none");
        core_free(core);
        return NULL;
    }
    const char *missing = missing_processor(duhamel_processor);
    if (missing) {
        snprintf(message, MESSAGE_SIZE, "expected a processor with %s: export for an older one",
                 missing);
        core_free(core);
        return NULL;
    }
    const size_t n_inputs = (size_t)number(core, N_INPUTS);
    const size_t n_parameters = (size_t)words(core, PIECE_PARAMETERS);
    const size_t before = rounded(sizeof(Head) + 8 * (n_inputs + n_parameters));
    const size_t constant = (size_t)bytes(core, PIECE_CONSTANT);
    core->memory[0] = malloc(before + (size_t)bytes(core, PIECE_LIVE) + ALIGNMENT);
    core->memory[1] = malloc((size_t)bytes(core, PIECE_WORDS));
    /* Constant arrays are shared by all instances, but where parameters may change them. */
    core->memory[2] = n_parameters ? malloc(constant + ALIGNMENT) : NULL;
    /* Long steps are taken back where a contact closes in them. */
    const int has_flight = number(core, RATIO) > 1;
    core->memory[3] = has_flight ? malloc((size_t)bytes(core, PIECE_LIVE)) : NULL;
    core->before_flight = core->memory[3];
    if (!core->memory[0] || !core->memory[1] || (n_parameters && !core->memory[2]) ||
        (has_flight && !core->memory[3])) {
        snprintf(message, MESSAGE_SIZE, "out of memory");
        core_free(core);
        return NULL;
    }
    core->head = aligned(core->memory[0]);
    core->inputs = (double *)(core->head + 1);
    core->parameters = core->inputs + n_inputs;
    core->live = (unsigned char *)core->head + before;
    core->constant = (unsigned char *)piece(core, PIECE_CONSTANT);
    if (n_parameters) core->constant = memcpy(aligned(core->memory[2]), core->constant, constant);
    const size_t n_words = (size_t)bytes(core, PIECE_WORDS);
    core->words = memcpy(core->memory[1], piece(core, PIECE_WORDS), n_words);
    const int64_t *at = piece(core, PIECE_RELOCATIONS);
    for (int64_t i = 0; i < words(core, PIECE_RELOCATIONS); i += 3) {
        unsigned char *segment = at[i + 1] == LIVE_SEGMENT ? core->live : core->constant;
        core->words[at[i]] = (int64_t)(intptr_t)(segment + at[i + 2]);
    }
    core_reset(core);
    return core;
}

void core_free(Core *core) {
    if (!core) return;
    for (int i = 0; i < 4; i++) free(core->memory[i]);
    free(core);
}

/* The parameters of the block, into the constant arrays. */
static void apply_parameters(Core *core) {
    const int64_t *at = piece(core, PIECE_PARAMETERS);
    for (int64_t i = 0; i < words(core, PIECE_PARAMETERS); i++)
        memcpy(core->constant + at[i], &core->parameters[i], 8);
}

void core_reset(Core *core) {
    memset(core->head, 0, (size_t)(core->live - (unsigned char *)core->head));
    memcpy(core->head->digest, core->image + HEADER_DIGEST, sizeof core->head->digest);
    core->head->size = (int64_t)core_state_size(core);
    core->head->stop = INFINITY;
    memcpy(core->live, piece(core, PIECE_LIVE), (size_t)bytes(core, PIECE_LIVE));
    const unsigned char *constant = piece(core, PIECE_CONSTANT);
    const int64_t *at = piece(core, PIECE_PARAMETERS);
    for (int64_t i = 0; i < words(core, PIECE_PARAMETERS); i++)
        memcpy(&core->parameters[i], constant + at[i], 8);
    apply_parameters(core);
    at = piece(core, PIECE_INPUTS);
    for (int64_t i = 0; i < words(core, PIECE_INPUTS); i += 2)
        memcpy(&core->inputs[at[i]], core->live + at[i + 1], 8);
}

int core_fails(Core *core, const char *format, ...) {
    va_list values;
    va_start(values, format);
    vsnprintf(core->message, sizeof core->message, format, values);
    va_end(values);
    core->head->mode = TERMINATED;
    return 1;
}

/* Time and steps */

double core_step_size(const Core *core) { return real(core, STEP); }

static double shortest_step(const Core *core) {
    return core_step_size(core) / (double)number(core, RATIO);
}

/* Steps are counted: a sum of their sizes would drift. */
double core_time(const Core *core) {
    return core->head->start + (double)core->head->step * core_step_size(core);
}

int core_setup(Core *core, double start, double stop) {
    if (!isfinite(start)) return core_fails(core, "startTime: expected a number, got %g", start);
    core->head->start = start;
    core->head->stop = stop;
    core->head->mode = INITIALIZING;
    return 0;
}

/* Takes the steps of the inputs, of one of the two sizes. */
static void advance(Core *core, void *run, int inputs, double results[2]) {
    duhamel_solver_step_loop_advance(results, run, record(core, inputs));
}

int core_start(Core *core) {
    double results[2];
    duhamel_solver_step_record_record(results, core->words, 0);
    advance(core, core->words, WORD_OF_NO_STEP, results);
    core->head->mode = STEPPING;
    /* One step that does not count: code and data are in the caches when the first one is due. */
    void *state = NULL;
    if (core_get_state(core, &state)) return 1;
    core_step(core, 1);
    memcpy(core->head, state, core_state_size(core));
    free(state);
    return 0;
}

int core_count(Core *core, double now, double size, int64_t *n) {
    const double h = core_step_size(core), time = core_time(core), count = floor(size / h + 0.5);
    if (!(fabs(now - time) <= STEP_ROUNDING * h))
        return core_fails(core, "currentCommunicationPoint: expected %.12g s, got %.12g", time,
                          now);
    if (!(count >= 1.0) || !(fabs(count * h - size) <= STEP_ROUNDING * h))
        return core_fails(core, "communicationStepSize: expected a multiple of the internal step "
                          "%.12g s, got %.12g, which is %.6g of it", h, size, size / h);
    if (time + size > core->head->stop + STEP_ROUNDING * h)
        return core_fails(core, "the step to %.12g s ends after stopTime %.12g s",
                          time + size, core->head->stop);
    *n = (int64_t)count;
    return 0;
}

/* The values of this step of all signals that are no inputs. */
static int set_signals(Core *core, int64_t step) {
    const int64_t last = number(core, N_STEPS), n = words(core, PIECE_SIGNAL_PLACES);
    if (last && step > last)
        return core_fails(core, "t = %.9g s is the end of this export: expected one of a model "
                          "with a later t_end", core->head->start + real(core, END));
    const double *row = (const double *)piece(core, PIECE_SIGNALS) + (step - 1) * n;
    const int64_t *at = piece(core, PIECE_SIGNAL_PLACES);
    for (int64_t i = 0; i < n; i++) memcpy(core->live + at[i], row + i, 8);
    return 0;
}

static void set_inputs(Core *core) {
    const int64_t *at = piece(core, PIECE_INPUTS);
    for (int64_t i = 0; i < words(core, PIECE_INPUTS); i += 2)
        memcpy(core->live + at[i + 1], &core->inputs[at[i]], 8);
}

static int newton_fails(Core *core, int64_t step, double time, double residual) {
    const double *phi = live(core, PLACE_OF_PHI);
    const int64_t *compliant = (const int64_t *)(core->constant + number(core, PLACE_OF_COMPLIANT));
    int64_t worst = -1;
    for (int64_t i = 0; i < number(core, N_ROWS); i++)
        /* Where the residual is no number, most rows have none that tells anything. */
        if (!compliant[i] && isfinite(phi[i]) &&
            fabs(phi[i]) > (worst < 0 ? 0.0 : fabs(phi[worst])))
            worst = i;
    return core_fails(core, "Newton's method failed at t = %.9g s (step %lld): residual %.3g, "
                      "tolerance %.3g%s%s", time, (long long)step, residual, real(core, TOLERANCE),
                      worst < 0 ? "" : "; farthest open: ",
                      worst < 0 ? "" : name(core, PIECE_ROWS, worst));
}

/* What a run refuses after a step: contacts that were missed, bodies and joints out of range. */
static int leaves_its_range(Core *core, double time) {
    const int64_t passed = *(int64_t *)live(core, PLACE_OF_PASSED);
    if (passed)
        return core_fails(core, "%s passed through what it should meet within one step, at "
                          "t = %.9g s: expected a smaller step",
                          name(core, PIECE_CONTACTS, passed - 1), time);
    const int64_t *shortest = live(core, PLACE_OF_SHORTEST);
    const double created = *(double *)live(core, PLACE_OF_SWITCHING);
    if (created > real(core, MOST_CREATED) * *(double *)live(core, PLACE_OF_MOVED))
        for (int64_t c = number(core, N_COUPLED_CONTACTS); c < number(core, N_CONTACTS); c++)
            if (shortest[c] > 0 && (double)shortest[c] < real(core, FEW_STEPS))
                return core_fails(core, "%s touched for %lld steps at the shortest and has created "
                                  "energy until t = %.9g s: expected a step of %.2g s or less",
                                  name(core, PIECE_CONTACTS, c), (long long)shortest[c], time,
                                  shortest_step(core) * (double)shortest[c] /
                                  real(core, GOOD_STEPS));
    const int64_t left = *(int64_t *)live(core, PLACE_OF_LEFT);
    if (left)
        return core_fails(core, "frame '%s' has left the range of linear elasticity at t = %.9g s",
                          name(core, PIECE_FRAMES, left - 1), time);
    return 0;
}

/* What a run checks now and then: joints on their branch, constraints that were left out. */
static int comes_apart(Core *core, double time) {
    double found = 0.0, gradient[12];
    void *work = record(core, WORD_OF_WORK);
    if (words(core, PIECE_BRANCHES))
        duhamel_solver_step_watches_wrong_branch(
            &found, record(core, WORD_OF_COUPLINGS), piece(core, PIECE_BRANCHES),
            words(core, PIECE_BRANCHES), work);
    if (found > 0.0)
        return core_fails(core, "%s: its shafts have passed 180 degrees against each other at "
                          "t = %.9g s", name(core, PIECE_ROWS, (int64_t)found - 1), time);
    if (words(core, PIECE_REMOVED) && core->head->step % STEPS_BETWEEN_CHECKS == 0)
        duhamel_solver_step_watches_open_row(
            &found, record(core, WORD_OF_REMOVED_ROWS), piece(core, PIECE_REMOVED),
            words(core, PIECE_REMOVED), piece(core, PIECE_REMOVED_LIMITS),
            words(core, PIECE_REMOVED_LIMITS), gradient, 12, work);
    if (found > 0.0)
        return core_fails(core, "%s was left out as redundant, but is open at t = %.9g s",
                          name(core, PIECE_REMOVED_NAMES, (int64_t)found - 1), time);
    return 0;
}

/* Loads older than the impulse responses are dropped, half a window at a time. */
static void shift_window(Core *core) {
    const int64_t span = number(core, SPAN), n = number(core, N_PAST);
    int64_t *first = live(core, PLACE_OF_FIRST);
    /* The next step has been prepared already, and its column is in use. */
    if (!span || core->head->step + 1 - *first != 2 * span) return;
    double *rows[2] = {live(core, PLACE_OF_P), live(core, PLACE_OF_U_AHEAD)};
    for (int k = 0; k < 2; k++)
        for (int64_t i = 0; i < number(core, N_DOFS); i++) {
            double *row = rows[k] + i * n;
            memcpy(row, row + span, (size_t)(span + 1) * 8);
            memset(row + span + 1, 0, (size_t)(n - span - 1) * 8);
        }
    *first += span;
}

/* The step to a time in shortest steps, of one of the two sizes; results as those of `advance`. */
static int take(Core *core, void *run, int64_t step, int recorded, double results[2]) {
    if (set_signals(core, step)) return 1;
    *(int64_t *)live(core, PLACE_OF_N_EVENTS) = 0;
    *(int64_t *)live(core, PLACE_OF_ROW) = recorded ? 0 : -1;
    advance(core, run, WORD_OF_INPUTS, results);
    return 0;
}

static double time_of(const Core *core, int64_t step) {
    return core->head->start + (double)step * shortest_step(core);
}

/* Whether no contact is closed or may be after a long step from here, and no signal jumps in it. */
static int may_fly(Core *core) {
    const int64_t *is_short = piece(core, PIECE_SHORT);
    if (core->head->step < words(core, PIECE_SHORT) && is_short[core->head->step]) return 0;
    double is_near = 0.0;
    duhamel_solver_step_loop_is_contact_near(&is_near, record(core, WORD_OF_SYSTEM),
                                             core_step_size(core), record(core, WORD_OF_STATE),
                                             record(core, WORD_OF_WORK));
    return is_near == 0.0;
}

static void change_size(Core *core, int64_t in_flight) {
    if (*(int64_t *)live(core, PLACE_OF_IN_FLIGHT) == in_flight) return;
    double nothing;
    duhamel_solver_step_sizes_change_size(
        &nothing, record(core, in_flight ? WORD_OF_SYSTEM : WORD_OF_FLYING_SYSTEM),
        record(core, in_flight ? WORD_OF_FLYING_SYSTEM : WORD_OF_SYSTEM),
        record(core, WORD_OF_STATE), record(core, WORD_OF_WORK));
}

/* The long step from here, or all as it was: a contact may close in it. 1: it was taken. */
static int fly(Core *core, int64_t end, int recorded, double results[2]) {
    const size_t size = (size_t)bytes(core, PIECE_LIVE);
    memcpy(core->before_flight, core->live, size);
    change_size(core, 1);
    if (take(core, record(core, WORD_OF_FLIGHT), end, recorded, results)) return 0;
    if (results[0] >= 1.0) return 1;
    memcpy(core->live, core->before_flight, size);
    return 0;
}

int core_step(Core *core, int recorded) {
    const int64_t ratio = number(core, RATIO), end = (core->head->step + 1) * ratio;
    double results[2];
    set_inputs(core);
    if (ratio > 1 && may_fly(core) && fly(core, end, recorded, results)) {
        if (leaves_its_range(core, time_of(core, end))) return 1;
    } else {
        if (ratio > 1) change_size(core, 0);
        for (int64_t step = end - ratio + 1; step <= end; step++) {
            if (take(core, core->words, step, recorded && step == end, results)) return 1;
            if (leaves_its_range(core, time_of(core, step))) return 1;
            if (results[0] < 1.0)
                return newton_fails(core, step, time_of(core, step), results[1]);
        }
    }
    core->head->step++;
    if (comes_apart(core, core_time(core))) return 1;
    shift_window(core);
    return 0;
}

/* Variables */

static const Variable *find(Core *core, uint32_t reference) {
    const Variable *all = piece(core, PIECE_VARIABLES);
    return reference < bytes(core, PIECE_VARIABLES) / (int64_t)sizeof *all ? &all[reference] : NULL;
}

int core_get(Core *core, uint32_t reference, double *value) {
    const Variable *variable = find(core, reference);
    if (!variable || variable->kind == KIND_INTEGER)
        return core_fails(core, "value reference %u: expected that of a real number", reference);
    if (variable->kind == KIND_TIME) *value = core_time(core);
    else if (variable->kind == KIND_INPUT) *value = core->inputs[variable->place];
    else if (variable->kind == KIND_PARAMETER) *value = core->parameters[variable->place];
    else memcpy(value, core->live + variable->place, 8);
    return 0;
}

int core_get_integer(Core *core, uint32_t reference, int64_t *value) {
    const Variable *variable = find(core, reference);
    if (!variable || variable->kind != KIND_INTEGER)
        return core_fails(core, "value reference %u: expected that of an integer", reference);
    memcpy(value, core->live + variable->place, 8);
    return 0;
}

int core_set(Core *core, uint32_t reference, double value) {
    const Variable *variable = find(core, reference);
    if (!variable || (variable->kind != KIND_INPUT && variable->kind != KIND_PARAMETER))
        return core_fails(core, "value reference %u: expected an input or a parameter", reference);
    if (!isfinite(value))
        return core_fails(core, "value reference %u: expected a number, got %g", reference, value);
    if (variable->kind == KIND_INPUT) {
        core->inputs[variable->place] = value;
        return 0;
    }
    core->parameters[variable->place] = value;
    apply_parameters(core);
    /* The factors of Newton's matrix belong to other parameters. */
    *(int64_t *)live(core, PLACE_OF_CURRENT) = 0;
    return 0;
}

/* States: one block of memory, without pointers */

size_t core_state_size(const Core *core) {
    return (size_t)(core->live - (unsigned char *)core->head) + (size_t)bytes(core, PIECE_LIVE);
}

int core_get_state(Core *core, void **state) {
    const size_t size = core_state_size(core);
    if (!*state) *state = malloc(size);
    if (!*state) return core_fails(core, "out of memory");
    memcpy(*state, core->head, size);
    return 0;
}

int core_check_state(Core *core, const void *state, size_t size) {
    Head head;
    if (state && size >= sizeof head) {
        memcpy(&head, state, sizeof head);
        if (size == core_state_size(core) && head.size == core->head->size &&
            !memcmp(head.digest, core->head->digest, sizeof head.digest))
            return 0;
    }
    return core_fails(core, "expected a state of this export, got one of another");
}

int core_set_state(Core *core, const void *state) {
    if (core_check_state(core, state, core_state_size(core))) return 1;
    memcpy(core->head, state, core_state_size(core));
    apply_parameters(core);
    return 0;
}
