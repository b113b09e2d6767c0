"""A headless Chromium for tests of pages, driven over the WebDriver protocol (W3C) of Debian's chromium-driver."""

from __future__ import annotations

import base64
import json
import re
import shutil
import subprocess
import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

BINARIES = ("chromium", "chromium-browser", "google-chrome")
ENTER = "\ue007"
ESCAPE = "\ue00c"
_ELEMENT = "element-6066-11e4-a52e-4f735466cecf"


def missing() -> str | None:
    """Returns the missing programs as a reason to skip, or None if all are installed."""
    if not any(map(shutil.which, BINARIES)) or not shutil.which("chromedriver"):
        return "no headless browser: apt-get install chromium chromium-driver"
    return None


class Browser:
    """One window of a fixed size without a network. The caller closes it."""

    def __init__(self, profile: Path, *, width: int = 1280, height: int = 900, dark: bool = False) -> None:
        """Starts driver and browser.

        Args:
            profile: an empty folder that the browser may fill.
            width: of the page, pixels.
            height: of the page, pixels.
            dark: whether pages prefer the dark colour scheme.
        """
        binary = next(path for path in map(shutil.which, BINARIES) if path)
        self._driver = subprocess.Popen(
            ["chromedriver", "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        assert self._driver.stdout is not None
        ports = (re.search(r"started successfully on port (\d+)", line) for line in self._driver.stdout)
        self._root = f"http://127.0.0.1:{next(port for port in ports if port)[1]}"
        options = [
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--hide-scrollbars",
            "--disable-dev-shm-usage",
            "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",  # nothing is fetched from anywhere else
            f"--user-data-dir={profile}",
            *(["--blink-settings=preferredColorScheme=0"] if dark else []),
        ]
        preferences = {
            "goog:chromeOptions": {"binary": binary, "args": options},
            "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"},
        }
        session = self._call("POST", "/session", {"capabilities": {"alwaysMatch": preferences}})
        self._root += f"/session/{session['sessionId']}"
        self.resize(width, height)

    def resize(self, width: int, height: int) -> None:
        """Sets the size of the page, which may be narrower than a window can be."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self._devtools("Emulation.setDeviceMetricsOverride", size)

    def open(self, file: Path, fragment: str = "") -> None:
        """Opens a page from disk and waits until it is loaded; earlier console errors and requests are dropped."""
        self.visit(file.resolve().as_uri() + fragment)

    def visit(self, address: str) -> None:
        """Opens a page by its address, as `open` does."""
        self.console_errors()
        self.requests()
        self._call("POST", "/url", {"url": address})

    def run(self, script: str, *values: object) -> Any:
        """Returns the value of a function body in JavaScript."""
        return self._call("POST", "/execute/sync", {"script": script, "args": list(values)})

    def click(self, css: str) -> None:
        """Clicks the first element that matches; the element must not be covered."""
        self._call("POST", f"/element/{self._find(css)}/click", {})

    def keys(self, css: str, text: str) -> None:
        """Types into the first element that matches."""
        self._call("POST", f"/element/{self._find(css)}/value", {"text": text})

    def console_errors(self) -> list[str]:
        """Returns the errors and warnings of the console since the last call."""
        log = self._call("POST", "/se/log", {"type": "browser"})
        return [entry["message"] for entry in log if entry["level"] in {"SEVERE", "WARNING"}]

    def requests(self) -> list[str]:
        """Returns the addresses that were requested since the last call, without those of the browser's own pages."""
        log = [
            json.loads(entry["message"])["message"] for entry in self._call("POST", "/se/log", {"type": "performance"})
        ]
        sent = [entry["params"]["request"]["url"] for entry in log if entry["method"] == "Network.requestWillBeSent"]
        return [address for address in sent if not address.startswith("chrome")]

    def screenshot(self, file: Path) -> None:
        """Writes the content of the window as a PNG file."""
        file.write_bytes(base64.b64decode(self._call("GET", "/screenshot")))

    def close(self) -> None:
        """Ends browser and driver."""
        try:
            self._call("DELETE", "")
        finally:
            self._driver.terminate()
            self._driver.wait()

    def _find(self, css: str) -> str:
        return self._call("POST", "/element", {"using": "css selector", "value": css})[_ELEMENT]

    def _devtools(self, command: str, parameters: dict[str, Any]) -> None:
        self._call("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def _call(self, method: str, path: str, content: dict[str, Any] | None = None) -> Any:
        body = None if content is None else json.dumps(content).encode()
        request = urllib.request.Request(self._root + path, body, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=60) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise AssertionError(json.load(error)["value"]["message"].splitlines()[0]) from None
