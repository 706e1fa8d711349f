"""From Python functions to machine code: records that it reads, marks, builds and the cache.

`struct` says how data lie in memory, `marks` which functions are compiled and which of them Python
may call, `object_file` finds the machine code, `cache` keeps it, `shipped` has that of wheels,
`digests` tells what it depends on, `build` makes it for `targets`, and `stock` is the slower way
through numba's public interface. docs/architecture.md says why.
"""
