#!/usr/bin/env python3
"""What viewers cost the loop: one run in wall-clock time, in which phases with viewers and without take turns.

    tools/bench/view/watched.py [--patella FILE] [--config FILE] [--phases N] [--phase-s SECONDS] [--cpu N]

With viewers means patella view and eight clients: six read everything, one reads nothing, one sends garbage. Quantiles are those
of the loop's own wake-up and execution in ticks.csv; the first second of each phase, in which programs start or end, is left
out. The ticks of a second are drawn again together for the interval of the ratio: they are not independent. With --cpu the loop has that
processor to itself, as on a rig, and the clients have the others; patella view keeps off it by itself.
"""
import argparse
import base64
import csv
import json
import os
import random
import re
import select
import socket
import subprocess
import sys
import tempfile
import threading
import time

READERS = 6
LEFT_OUT_S = 1.0
REDRAWN = 400


def frame(opcode, payload):
    """A message of a WebSocket's client, masked with zeros."""
    length = bytes([0x80 | len(payload)]) if len(payload) < 126 else bytes([0xFE]) + len(payload).to_bytes(2, "big")
    return bytes([0x80 | opcode]) + length + bytes(4) + payload


class Clients:
    """Eight of them, on a thread; they end with close()."""

    def __init__(self, port):
        self.sockets = [self.connect(port) for _ in range(READERS + 2)]
        wish = json.dumps({"op": "subscribe", "subscriptions": [{"id": i, "channelId": i} for i in range(6)]}).encode()
        for client in self.sockets[:-1]:
            client.sendall(frame(1, wish))
        self.received = 0
        self.open = True
        self.thread = threading.Thread(target=self.work)
        self.thread.start()

    @staticmethod
    def connect(port):
        client = socket.create_connection(("127.0.0.1", port))
        key = base64.b64encode(os.urandom(16)).decode()
        client.sendall(f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                       f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n"
                       "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n\r\n".encode())
        if b" 101 " not in client.recv(4096):
            raise RuntimeError("a client is not served")
        return client

    def work(self):
        readers, rude = self.sockets[:READERS], self.sockets[-1]
        while self.open:
            for client in select.select(readers, [], [], 0.05)[0]:
                self.received += len(client.recv(1 << 20))
            rude.sendall(frame(1, os.urandom(40).hex().encode()))

    def close(self):
        self.open = False
        self.thread.join()
        for client in self.sockets:
            client.close()


class Viewers:
    def __init__(self, patella, run):
        self.server = subprocess.Popen([patella, "view", run, "--listen", "127.0.0.1:0"], stdout=subprocess.PIPE, text=True)
        self.clients = Clients(int(re.search(r":(\d+)\n", self.server.stdout.readline())[1]))
        self.start = time.time()

    def end(self):
        """Bytes that were read, seconds, and the server's seconds of a processor."""
        lived_s = time.time() - self.start
        self.clients.close()
        self.server.terminate()
        usage = os.wait4(self.server.pid, 0)[2]
        return self.clients.received, lived_s, usage.ru_utime + usage.ru_stime


def quantile(values, share):
    return sorted(values)[min(int(share * len(values)), len(values) - 1)]


def pooled(seconds, share):
    return quantile([value for second in seconds for value in second], share)


def watched_run(arguments, folder):
    """Runs the loop, and returns [time of the wall, whether there were viewers] of each phase, and the sums of what Viewers.end() says."""
    run = os.path.join(folder, "run")
    duration_s = (arguments.phases + 1) * arguments.phase_s
    loop = subprocess.Popen([arguments.patella, "run", "--config", arguments.config, "--clock", "monotonic", "--duration",
                             str(duration_s), "--out", run] + (["--cpus", str(arguments.cpu)] if arguments.cpu is not None else []),
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while not os.path.exists(os.path.join(run, "ticks.csv")):
        time.sleep(0.05)
    time.sleep(2)
    phases, spent = [], [0, 0.0, 0.0]
    for number in range(arguments.phases):
        watched = number % 2 == 1
        viewers = Viewers(arguments.patella, run) if watched else None
        start = time.time()
        time.sleep(arguments.phase_s - 1)
        phases.append((start + LEFT_OUT_S, time.time(), watched))
        spent = [a + b for a, b in zip(spent, viewers.end())] if viewers else spent
        time.sleep(1)
    loop.terminate()
    loop.wait()
    return run, phases, spent


def seconds_of(run, phases):
    """{watched: {column: [values of each second]}}."""
    with open(os.path.join(run, "frames.log"), encoding="utf-8") as file:
        epoch = float(re.match(r"\((\d+\.\d+)\)", file.readline())[1])
    found = {kind: {"wakeup_us": {}, "execution_us": {}} for kind in (False, True)}
    with open(os.path.join(run, "ticks.csv"), encoding="utf-8") as file:
        for row in csv.DictReader(file):
            at = epoch + float(row["t_s"])
            for start, end, watched in phases:
                if start <= at < end:
                    for column, seconds in found[watched].items():
                        seconds.setdefault(int(at), []).append(float(row[column]))
    return {kind: {column: list(seconds.values()) for column, seconds in columns.items()} for kind, columns in found.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..")
    parser.add_argument("--patella", default=os.path.join(root, "build/release/firmware_app/patella"))
    parser.add_argument("--config", default=os.path.join(root, "firmware_app/config/adult.toml"))
    parser.add_argument("--phases", type=int, default=20, help="without and with viewers in turns")
    parser.add_argument("--phase-s", type=float, default=10.0)
    parser.add_argument("--cpu", type=int, help="processor of the loop; the clients have the others")
    arguments = parser.parse_args()
    if arguments.cpu is not None:
        os.sched_setaffinity(0, os.sched_getaffinity(0) - {arguments.cpu})
    with tempfile.TemporaryDirectory() as folder:
        run, phases, (received, watched_s, processor_s) = watched_run(arguments, folder)
        with open(os.path.join(run, "summary.json"), encoding="utf-8") as file:
            recorder = json.load(file)["recorder"]
        seconds = seconds_of(run, phases)
    print(f"{'us':<14}{'':>10}{'p50':>10}{'p99':>10}{'p99.9':>10}{'max':>10}{'ticks':>10}")
    dice = random.Random(1)
    for column in ("wakeup_us", "execution_us"):
        for watched in (False, True):
            values = [value for second in seconds[watched][column] for value in second]
            cells = "".join(f"{quantile(values, share):>10.1f}" for share in (0.5, 0.99, 0.999, 1.0))
            print(f"{column:<14}{'with' if watched else 'without':>10}{cells}{len(values):>10}")
        ratios = []
        for _ in range(REDRAWN):
            drawn = {kind: dice.choices(seconds[kind][column], k=len(seconds[kind][column])) for kind in (False, True)}
            ratios.append(pooled(drawn[True], 0.999) / pooled(drawn[False], 0.999))
        ratio = pooled(seconds[True][column], 0.999) / pooled(seconds[False][column], 0.999)
        print(f"{'':<14}p99.9 with / without: {ratio:.3f}, 95 % within {quantile(ratios, 0.025):.3f} to {quantile(ratios, 0.975):.3f}")
    print(f"the server took {processor_s / watched_s:.0%} of a processor, and sent {1e-6 * received / watched_s:.1f} MB a second; the recorder dropped {recorder['ticks_dropped']} ticks and {recorder['frames_dropped']} frames")
    return 0


if __name__ == "__main__":
    sys.exit(main())
