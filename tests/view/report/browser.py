"""A headless Chromium that is driven through a pipe, by the protocol of its developer tools."""

import base64
import json
import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome")
SOFTWARE_WEBGL = ("--enable-unsafe-swiftshader", "--use-gl=angle", "--use-angle=swiftshader")
NO_WEBGL = ("--disable-gpu", "--disable-3d-apis")
OPTIONS = (
    "--headless=new",
    "--no-sandbox",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-dev-shm-usage",
    "--host-resolver-rules=MAP * ~NOTFOUND",
    "--remote-debugging-pipe",
    "--window-size=1280,900",
)


def executable() -> str | None:
    """Where Chromium is, if it is installed."""
    return next(filter(None, map(shutil.which, NAMES)), None)


class Browser:
    """One page.

    requests: the addresses that it asked for; errors: what its console had of errors, and what was
    thrown and not caught.
    """

    def __init__(self, to_browser: int, from_browser: int) -> None:
        self._out, self._in = os.fdopen(to_browser, "wb"), os.fdopen(from_browser, "rb")
        self._last, self._rest, self._session = 0, b"", ""
        self.requests: list[str] = []
        self.errors: list[str] = []
        target = self._call("Target.createTarget", url="about:blank")["targetId"]
        attached = self._call("Target.attachToTarget", targetId=target, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self._call(f"{domain}.enable")

    def open(self, path: Path) -> None:
        self._call("Page.navigate", url=path.resolve().as_uri())

    def run(self, expression: str) -> Any:
        """The value of an expression of JavaScript, or of its promise."""
        answer = self._call(
            "Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True
        )
        if "exceptionDetails" in answer:
            raise AssertionError(answer["exceptionDetails"])
        return answer["result"].get("value")

    def picture(self, path: Path, whole: bool = False) -> None:
        """Write what is seen, or the whole page, as PNG."""
        answer = self._call("Page.captureScreenshot", captureBeyondViewport=whole)
        path.write_bytes(base64.b64decode(answer["data"]))

    def paper(self, path: Path) -> None:
        """Write the page as it is printed, as PDF."""
        answer = self._call("Page.printToPDF", printBackground=True)
        path.write_bytes(base64.b64decode(answer["data"]))

    def close(self) -> None:
        self._session = ""
        self._call("Browser.close")
        self._out.close()
        self._in.close()

    def _call(self, method: str, **parameters: Any) -> Any:
        self._last += 1
        message: dict[str, Any] = {"id": self._last, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        self._out.write(json.dumps(message).encode() + b"\0")
        self._out.flush()
        while True:
            answer = self._receive()
            if answer.get("id") == self._last:
                if "error" in answer:
                    raise AssertionError(f"{method}: {answer['error']}")
                return answer["result"]
            self._note(answer.get("method", ""), answer.get("params", {}))

    def _receive(self) -> Any:
        while b"\0" not in self._rest:
            chunk = os.read(self._in.fileno(), 1 << 20)
            if not chunk:
                raise AssertionError("Chromium has ended")
            self._rest += chunk
        message, _, self._rest = self._rest.partition(b"\0")
        return json.loads(message)

    def _note(self, event: str, of: dict[str, Any]) -> None:
        if event == "Network.requestWillBeSent":
            self.requests.append(of["request"]["url"])
        elif event == "Runtime.exceptionThrown":
            self.errors.append(json.dumps(of["exceptionDetails"])[:2000])
        elif event == "Runtime.consoleAPICalled" and of["type"] in ("error", "assert"):
            self.errors.append(json.dumps(of["args"])[:2000])
        elif event == "Log.entryAdded" and of["entry"]["level"] == "error":
            self.errors.append(of["entry"]["text"])


@contextmanager
def browser(*options: str) -> Iterator[Browser]:
    """Chromium until the block ends, without any network."""
    program = executable()
    assert program is not None
    to_child, from_child = os.pipe(), os.pipe()
    with TemporaryDirectory() as profile:
        command = [program, *OPTIONS, *options, f"--user-data-dir={profile}", "about:blank"]
        redirected = f'exec "$@" 3<&{to_child[0]} 4>&{from_child[1]}'
        process = subprocess.Popen(
            ["sh", "-c", redirected, "sh", *command],
            pass_fds=(to_child[0], from_child[1]),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(to_child[0])
        os.close(from_child[1])
        try:
            page = Browser(to_child[1], from_child[0])
            yield page
            page.close()
        finally:
            process.kill()
            process.wait()
