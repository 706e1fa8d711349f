/* How long steps take: prints the times of n of them [ns], one a line. Linked with an export. */
#define _POSIX_C_SOURCE 199309L
#include "core.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static long long now(void) {
    struct timespec time;
#ifdef CLOCK_MONOTONIC
    clock_gettime(CLOCK_MONOTONIC, &time);
#else
    timespec_get(&time, TIME_UTC);
#endif
    return (long long)time.tv_sec * 1000000000 + time.tv_nsec;
}

int main(int n_arguments, char **arguments) {
    char message[MESSAGE_SIZE] = "expected a token and a number of steps";
    const long n = n_arguments > 2 ? atol(arguments[2]) : 0;
    long long *times = n > 0 ? malloc((size_t)n * sizeof *times) : NULL;
    Core *core = times ? core_new(arguments[1], message) : NULL;
    if (!core) return fprintf(stderr, "%s\n", message), 1;
    for (long i = 0; i < n; i++) {
        /* From the start again where the model has ended. */
        if (core->head->mode != STEPPING) {
            core_reset(core);
            core_start(core);
        }
        const long long start = now();
        if (core_step(core, 1) && core->head->step == 0)
            return fprintf(stderr, "%s\n", core->message), 1;
        times[i] = now() - start;
    }
    for (long i = 0; i < n; i++) printf("%lld\n", times[i]);
    return 0;
}
