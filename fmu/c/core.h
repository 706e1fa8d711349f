/* A Duhamel model without Python: an image of its arrays, stepped by the compiled time loop.

   No globals, no files, and no memory that is asked for but by `core_new` and for states. Functions
   that return an int return 0, or 1 with a message in the model, which then takes no steps until it
   is reset or given a state. */
#ifndef DUHAMEL_CORE_H
#define DUHAMEL_CORE_H
#include <stddef.h>
#include <stdint.h>

enum Kind { KIND_TIME, KIND_INPUT, KIND_PARAMETER, KIND_REAL, KIND_INTEGER };
enum Mode { INSTANTIATED, INITIALIZING, STEPPING, UPDATING, TERMINATED };
enum { MESSAGE_SIZE = 512 };

/* place: number of an input or a parameter, offset in the live arrays of all others */
typedef struct { int64_t kind, place; } Variable;

/* The head of the block of all that changes: head, inputs, parameters, live arrays. */
typedef struct {
    uint64_t digest[4];
    int64_t size, mode, step;
    double start, stop;
} Head;

typedef struct Core Core;
struct Core {
    const int64_t *image;
    unsigned char *constant, *live;
    double *inputs, *parameters;
    int64_t *words;
    Head *head;
    void *memory[4], *before_flight;
    char token[65], message[MESSAGE_SIZE];
};

Core *core_new(const char *token, char message[MESSAGE_SIZE]);
void core_free(Core *);
void core_reset(Core *);
int core_setup(Core *, double start, double stop);
int core_start(Core *);                     /* prepares the first step */
double core_time(const Core *);
double core_step_size(const Core *);
int core_count(Core *, double now, double size, int64_t *n);   /* the steps of this size */
int core_step(Core *, int recorded);        /* to the present inputs; outputs are those recorded */
int core_fails(Core *, const char *format, ...);

int core_get(Core *, uint32_t reference, double *value);
int core_get_integer(Core *, uint32_t reference, int64_t *value);
int core_set(Core *, uint32_t reference, double value);

size_t core_state_size(const Core *);
int core_get_state(Core *, void **state);   /* into memory that is there, or new */
int core_set_state(Core *, const void *state);
int core_check_state(Core *, const void *state, size_t size);
#endif
