"""Looks at every page of the built documentation in Chromium, as phones and screens show it.

    python tools/check_site.py build/site

It tells of errors in the console, requests to other places, and pages that are wider than the
window; dark at 400 px, light at 1300. Without Chromium it says so, which is a failure where the
environment has CI set.
"""

import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

from browser import Browser, browser, executable

WINDOWS = ((400, "dark"), (1300, "light"))
# That they exist MkDocs knows; to play all films of the gallery takes a processor.
NO_IMAGES = "--blink-settings=imagesEnabled=false"
# Pages that show sources are code alone, and hundreds.
LEFT_OUT = ("sources", "api")
READY = """new Promise((resolve) => {
  const done = () => document.readyState === "complete" ? resolve(true) : setTimeout(done, 20);
  done();
})"""
# The second frame after a change has its layout.
LAID_OUT = """new Promise((resolve) => {
  requestAnimationFrame(() => requestAnimationFrame(() => resolve(true)));
})"""
# Wide tables scroll by themselves; what makes the whole page scroll is named.
WIDE = """(() => {
  const most = document.documentElement.clientWidth + 1;
  if (document.documentElement.scrollWidth <= most) return "";
  const cut = (e) => getComputedStyle(e).overflowX !== "visible";
  const scrolls = (e) => e && (cut(e) || scrolls(e.parentElement));
  const wide = [...document.querySelectorAll("article *")].filter(
    (e) => e.getBoundingClientRect().right > most && !scrolls(e.parentElement));
  const words = (e) => `${e.tagName.toLowerCase()} ${e.textContent.trim().slice(0, 30)}`;
  return wide.slice(0, 3).map(words).join("; ") || "the page";
})()"""


def main() -> int:
    """Print what is wrong, a line each."""
    site = Path(sys.argv[1])
    if executable() is None:
        print("no Chromium: the site was not looked at", file=sys.stderr)
        return int(bool(os.environ.get("CI")))
    pages = sorted(
        path
        for path in site.rglob("*.html")
        if path.relative_to(site).parts[0] not in LEFT_OUT and path.name != "404.html"
    )
    found = []
    with _served(site) as address, browser(NO_IMAGES) as shown:
        for page in (path.relative_to(site).as_posix() for path in pages):
            found += [f"{page}: {fault}" for fault in _faults(shown, address, page)]
    for line in found:
        print(line)
    print(f"{len(pages)} pages, {len(found)} faults")
    return int(bool(found))


class _Handler(SimpleHTTPRequestHandler):
    def log_message(self, *told: object) -> None:
        """Nothing for each request."""


@contextmanager
def _served(site: Path) -> Iterator[str]:
    """The address of the site: its search does not work from files."""
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(_Handler, directory=site)) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


def _faults(shown: Browser, site: str, page: str) -> Iterator[str]:
    shown.errors.clear()
    shown.requests.clear()
    shown.visit(site + page)
    shown.run(READY)
    for width, scheme in WINDOWS:
        shown.emulate(width, scheme)
        shown.run(LAID_OUT)
        # Menus slide in and out for a moment.
        if shown.run(WIDE):
            time.sleep(1.0)
        if wide := shown.run(WIDE):
            yield f"wider than {width} px, {scheme}: {wide}"
    yield from (f"console: {error[:300]}" for error in shown.errors)
    for address in shown.requests:
        if not address.startswith((site, "data:", "blob:")):
            yield f"asks for {address}"


if __name__ == "__main__":
    sys.exit(main())
