/* Whether the processor can run the compiled time step: better a message than a crash. */
#include "processor.h"

#if defined(__x86_64__)
#include <cpuid.h>

/* x86-64-v3, with the registers of AVX kept by the system. */
static int has_v3(void) {
    unsigned a, b, c, d, low, high;
    const unsigned needed_1 = bit_FMA | bit_MOVBE | bit_F16C | bit_OSXSAVE | bit_AVX;
    const unsigned needed_7 = bit_AVX2 | bit_BMI | bit_BMI2;
    if (!__get_cpuid(1, &a, &b, &c, &d) || (c & needed_1) != needed_1) return 0;
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    if ((low & 6) != 6) return 0;
    return __get_cpuid_count(7, 0, &a, &b, &c, &d) && (b & needed_7) == needed_7;
}
#endif

const char *missing_processor(int level) {
#if defined(__x86_64__)
    if (level >= 3 && !has_v3()) return "x86-64-v3, as of 2013 and later";
#endif
    return level > 3 ? "more than there is" : 0;
}
