#!/usr/bin/env python3
"""Runs QEMU for run.sh: shows the board's serial console live, keeps it, and works the board's GPIO lines.

console.py --limit SECONDS --folder DIR -- QEMU ARGUMENT...

A line of the console that begins with "@host" asks for something from outside the board:
  @host line N LEVEL...   drives input N of the GPIO controller through LEVELs (0 or 1), one after the other
  @host powerdown         presses the power button, wired to line 3: a pulse of 100 ms
What was asked for is done when the file "answered" stands in DIR: the board can wait for it (guest/host_call.cpp).
Exit status: 0 when QEMU ended by itself, 1 when it had to be ended after the limit.
"""
import argparse
import json
import os
import pathlib
import socket
import subprocess
import sys
import threading
import time


def connect(path, process):
    """A socket that QEMU opens while it starts."""
    end = time.monotonic() + 30
    while True:
        peer = socket.socket(socket.AF_UNIX)
        try:
            peer.connect(path)
            return peer.makefile("rw", encoding="utf-8")
        except OSError:
            peer.close()
            if time.monotonic() > end or process.poll() is not None:
                raise
            time.sleep(0.02)


class Monitor:
    """QEMU's machine protocol, and the test protocol that reaches the inputs of a device."""

    def __init__(self, folder, process):
        self.qmp = connect(os.path.join(folder, "qmp"), process)
        self.qtest = connect(os.path.join(folder, "qtest"), process)
        self.qmp.readline()
        self.execute("qmp_capabilities")
        self.gpio = None

    def execute(self, command, **arguments):
        self.qmp.write(json.dumps({"execute": command, "arguments": arguments}) + "\n")
        self.qmp.flush()
        while True:
            answer = json.loads(self.qmp.readline())
            if "return" in answer:
                return answer["return"]
            if "error" in answer:
                raise RuntimeError(f"{command}: {answer['error']['desc']}")

    def gpio_path(self):
        if self.gpio is None:
            folder = "/machine/unattached"
            self.gpio = next(folder + "/" + one["name"] for one in self.execute("qom-list", path=folder)
                             if one["type"] == "child<pl061>")
        return self.gpio

    def drive(self, line, levels):
        for level in levels:
            self.qtest.write(f"set_irq_in {self.gpio_path()} unnamed-gpio-in {line} {level}\n")
        self.qtest.flush()
        for level in levels:
            answer = self.qtest.readline().strip()
            if not answer.startswith("OK"):
                raise RuntimeError(f"line {line} to {level}: {answer}")

    def obey(self, words):
        if words[:1] == ["line"] and len(words) > 2:
            self.drive(int(words[1]), [int(level) for level in words[2:]])
        elif words == ["powerdown"]:
            self.execute("system_powerdown")
        else:
            raise RuntimeError("@host " + " ".join(words) + ": expected 'line N LEVEL...' or 'powerdown'")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--limit", type=float, required=True)
    parser.add_argument("--folder", required=True)
    parser.add_argument("qemu", nargs="+")
    options = parser.parse_args()

    sockets = ["-qtest-log", "/dev/null"]
    for protocol in ("qmp", "qtest"):
        sockets += ["-" + protocol, f"unix:{protocol},server=on,wait=off"]
    process = subprocess.Popen(options.qemu + sockets, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               cwd=options.folder)
    expired = threading.Event()

    def end():
        expired.set()
        process.kill()

    timer = threading.Timer(options.limit, end)
    timer.start()
    try:
        monitor = Monitor(options.folder, process)
        with open(os.path.join(options.folder, "serial.log"), "wb") as log:
            for line in process.stdout:
                log.write(line)
                log.flush()
                sys.stdout.buffer.write(line)
                sys.stdout.flush()
                words = line.decode("utf-8", "replace").split()
                if words[:1] == ["@host"]:
                    monitor.obey(words[1:])
                    pathlib.Path(options.folder, "answered").touch()
        process.wait()
    finally:
        timer.cancel()
        process.kill()
    if expired.is_set():
        print(f"console.py: the board did not end within {options.limit:g} s", file=sys.stderr)
    return 1 if expired.is_set() else 0


if __name__ == "__main__":
    sys.exit(main())
