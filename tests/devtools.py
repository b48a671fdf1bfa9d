"""A headless Chromium that shows one page, driven over pipes (DevTools protocol)."""
import base64
import json
import os
import select
import shutil
import subprocess
import time

NAMES = ("chromium", "chromium-browser", "google-chrome")


def find():
    """Path of the browser; None: not installed."""
    return next((path for path in map(shutil.which, NAMES) if path), None)


class Browser:
    """all: the processes that were started"""
    all = []

    def __init__(self, url, folder, size, patience=60.0):
        self.patience, self.number, self.buffer, self.events = patience, 0, b"", []
        to_read, self.to = os.pipe()
        self.answers, from_write = os.pipe()
        ends = (3, to_read), (4, from_write)

        def place():  # the browser reads from descriptor 3 and writes to 4
            copies = [(target, os.dup2(end, 10 + target)) for target, end in ends]
            for target, copy in copies:
                os.dup2(copy, target)

        self.process = subprocess.Popen(
            [find(), "--headless", "--remote-debugging-pipe", f"--user-data-dir={folder}/profile",
             f"--window-size={size[0]},{size[1]}", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
             "--hide-scrollbars", "--no-first-run", "--disable-background-networking", "--disable-component-update",
             "--disable-sync", "--disable-quic", *([] if os.geteuid() else ["--no-sandbox"])],
            preexec_fn=place, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.all.append(self.process)
        os.close(to_read)
        os.close(from_write)
        self.session = None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.call("Runtime.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=1, mobile=False)
        self.call("Page.navigate", url=url)

    def receive(self):
        end = time.monotonic() + self.patience
        while b"\0" not in self.buffer:
            ready, _, _ = select.select([self.answers], [], [], max(0.0, end - time.monotonic()))
            piece = os.read(self.answers, 1 << 20) if ready else b""
            if not piece:
                raise RuntimeError("the browser does not answer")
            self.buffer += piece
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)

    def errors(self):
        """Exceptions in the page so far."""
        return [event["params"]["exceptionDetails"]["exception"].get("description")
                for event in self.events if event.get("method") == "Runtime.exceptionThrown"]

    def evaluate(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression}: {result['exceptionDetails']['exception'].get('description')}")
        return result["result"].get("value")

    def wait(self, expression, seconds=40.0):
        """Waits until the value of an expression is true, and returns it."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            value = self.evaluate(expression)
            if value:
                return value
            time.sleep(0.05)
        raise AssertionError(f"still false after {seconds} s: {expression}; {self.errors()}")

    def mouse(self, kind, x, y, buttons=0):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, buttons=buttons, clickCount=1,
                  button="left" if kind != "mouseMoved" else "none")

    def drag(self, path, release=True):
        """Presses the left button at the first point and moves along the others."""
        self.mouse("mouseMoved", *path[0])
        self.mouse("mousePressed", *path[0], buttons=1)
        for point in path[1:]:
            self.mouse("mouseMoved", *point, buttons=1)
            time.sleep(0.02)
        if release:
            self.mouse("mouseReleased", *path[-1])

    def press(self, key, code=0):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, windowsVirtualKeyCode=code,
                      **({"text": key} if kind == "keyDown" and len(key) == 1 else {}))

    def picture(self, path):
        with open(path, "wb") as file:
            file.write(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))

    def close(self):
        self.process.terminate()
        self.process.wait()
        os.close(self.to)
        os.close(self.answers)
