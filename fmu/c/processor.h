#ifndef DUHAMEL_PROCESSOR_H
#define DUHAMEL_PROCESSOR_H
/* The processor that is needed for a level of x86-64, where this is a lesser one; else NULL. */
const char *missing_processor(int level);
#endif
