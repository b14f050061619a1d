"""Headless Chromium for tests, and what they say."""
import base64
import json
import os
import shutil
import signal
import subprocess
import sys

HEIGHT = 900


def chromium_or_skip(what):
    """The program's path; without it, ends the test as one that is skipped."""
    chromium = shutil.which("chromium")
    if chromium is None:
        print("=" * 66 + f"\nSKIPPED, {what} was NOT looked at: no chromium (package chromium)\n" + "=" * 66, file=sys.stderr)
        sys.exit(77)
    return chromium


class Browser:
    """Chromium's DevTools protocol over a pair of pipes: JSON messages that end with a zero byte."""

    def __init__(self, program, profile, timeout_s):
        to_browser, self.writer = os.pipe()
        self.reader, from_browser = os.pipe()
        # The protocol's own file descriptors are 3 and 4; pipes that stand there already must survive being put in place.
        sources = [os.dup(to_browser), os.dup(from_browser)]
        while min(sources) < 5:
            sources = [os.dup(source) for source in sources]

        def place():
            os.dup2(sources[0], 3)
            os.dup2(sources[1], 4)

        self.process = subprocess.Popen(
            ["timeout", str(timeout_s), program, "--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
             "--no-first-run", "--remote-debugging-pipe", f"--user-data-dir={profile}", "about:blank"],
            preexec_fn=place, close_fds=False, start_new_session=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for source in (to_browser, from_browser, *sources):
            os.close(source)
        self.buffer = b""
        self.events = []
        self.number = 0
        self.session = None

    def message(self):
        while b"\0" not in self.buffer:
            more = os.read(self.reader, 1 << 20)
            if not more:
                raise RuntimeError("Chromium has ended")
            self.buffer += more
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, **parameters):
        self.number += 1
        request = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            request["sessionId"] = self.session
        os.write(self.writer, json.dumps(request).encode() + b"\0")
        while True:
            answer = self.message()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)

    def open(self, address, scripts=True):
        self.call("Emulation.setScriptExecutionDisabled", value=not scripts)
        self.events.clear()
        self.call("Page.navigate", url=address)
        while not any(event.get("method") == "Page.loadEventFired" for event in self.events):
            self.events.append(self.message())

    def attach(self):
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable")

    def evaluate(self, expression):
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{expression}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    @staticmethod
    def requests(events):
        """Addresses that were asked for, those of WebSockets included."""
        asked = [event["params"]["request"]["url"] for event in events if event.get("method") == "Network.requestWillBeSent"]
        return asked + [event["params"]["url"] for event in events if event.get("method") == "Network.webSocketCreated"]

    @staticmethod
    def errors(events):
        """What stands on the console as an error or a warning."""
        return [event["params"] for event in events if event.get("method") in ("Runtime.exceptionThrown", "Log.entryAdded")
                or event.get("method") == "Runtime.consoleAPICalled" and event["params"]["type"] in ("error", "warning", "assert")]

    def width(self, pixels, height=HEIGHT):
        self.call("Emulation.setDeviceMetricsOverride", width=pixels, height=height, deviceScaleFactor=1, mobile=False)
        self.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def picture(self, path, whole=True):
        data = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole)["data"]
        with open(path, "wb") as file:
            file.write(base64.b64decode(data))

    def close(self):
        os.close(self.writer)
        try:
            self.process.wait(5)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()


class Check:
    def __init__(self):
        self.failures = 0

    def __call__(self, holds, words):
        print(("ok    " if holds else "FAILS ") + words, flush=True)
        self.failures += not holds
