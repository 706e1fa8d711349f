/* Counts what the steps of an FMU allocate: allocations LIBRARY TOKEN H N. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

#include "fmi/fmi3FunctionTypes.h"

extern void *__libc_malloc(size_t);
static long count;

void *malloc(size_t n) {
    count++;
    return __libc_malloc(n);
}

int main(int n_arguments, char **arguments) {
    if (n_arguments < 5) return 2;
    void *library = dlopen(arguments[1], RTLD_NOW);
    if (!library) return fprintf(stderr, "%s\n", dlerror()), 1;
    fmi3InstantiateCoSimulationTYPE *instantiate =
        (fmi3InstantiateCoSimulationTYPE *)dlsym(library, "fmi3InstantiateCoSimulation");
    fmi3EnterInitializationModeTYPE *enter =
        (fmi3EnterInitializationModeTYPE *)dlsym(library, "fmi3EnterInitializationMode");
    fmi3ExitInitializationModeTYPE *leave =
        (fmi3ExitInitializationModeTYPE *)dlsym(library, "fmi3ExitInitializationMode");
    fmi3DoStepTYPE *step = (fmi3DoStepTYPE *)dlsym(library, "fmi3DoStep");
    fmi3GetFMUStateTYPE *keep = (fmi3GetFMUStateTYPE *)dlsym(library, "fmi3GetFMUState");
    fmi3SetFMUStateTYPE *put = (fmi3SetFMUStateTYPE *)dlsym(library, "fmi3SetFMUState");
    fmi3Instance one = instantiate("one", arguments[2], NULL, 0, 0, 0, 0, NULL, 0, NULL, NULL, NULL);
    if (!one || enter(one, 0, 0.0, 0.0, 0, 0.0) || leave(one)) return 1;
    fmi3FMUState state = NULL;
    if (keep(one, &state)) return 1;
    const double h = atof(arguments[3]);
    const long before = count;
    fmi3Boolean event, terminate, early;
    fmi3Float64 last;
    for (long n = 0; n < atol(arguments[4]); n++) {
        if (step(one, (double)n * h, h, 1, &event, &terminate, &early, &last)) return 1;
        if (keep(one, &state)) return 1;
    }
    if (put(one, state)) return 1;
    printf("%ld\n", count - before);
    return 0;
}
