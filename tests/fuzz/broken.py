"""A worker that crashes at file 2 and hangs at file 4, of six.

python -m tests.fuzz.broken NAME FIRST NUMBER FOLDER
"""

import os
import signal
import sys
import time

ANSWERS = {0: "read", 1: "refused", 3: "KeyError: 3"}


def main(first: int, count: int) -> None:
    print("ready", flush=True)
    for number in range(first, first + count):
        print(number, flush=True)
        if number == 2:
            os.kill(os.getpid(), signal.SIGSEGV)
        if number == 4:
            time.sleep(60)
        print(ANSWERS.get(number, "read"), flush=True)


if __name__ == "__main__":
    main(int(sys.argv[2]), int(sys.argv[3]))
