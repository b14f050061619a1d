#!/usr/bin/env python3
"""Looks at the page of `patella view` in headless Chromium: a live run with a fault and a reset, then a recorded one.

    page_in_browser.py PATELLA SOURCE_FOLDER [PICTURE-FOLDER]
    page_in_browser.py PATELLA SOURCE_FOLDER --hour

Pictures of what was seen are left in PICTURE-FOLDER; docs/pictures has two of them. --hour leaves the page open for an hour of
virtual time, and looks at its memory only. Exit status 77 where there is no Chromium.
"""
import csv
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "support"))
from browser import Browser, Check, chromium_or_skip

WIDTHS = {"desktop": 1280, "tablet": 800}
FAULT_S, RESET_S, LIVE_S = 8.0, 13.0, 16.0
ATTEMPTS = 3  # of what happens in wall-clock time: this machine may have stood still
RECORDED_S, RECORDED_FAULT_S = 70.0, 40.0

# A canvas with more than its background.
DRAWN = """[...document.querySelectorAll("#plots canvas")].map((canvas) => {
  const data = new Uint32Array(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.buffer);
  return new Set(data).size;
})"""
# Name of the file that the button for CSV would save, which holds the ends of the window.
SAVED_AS = """(() => {
  const click = HTMLAnchorElement.prototype.click;
  let name = "";
  HTMLAnchorElement.prototype.click = function () { name = this.download; };
  document.getElementById("export-csv").click();
  HTMLAnchorElement.prototype.click = click;
  return name;
})()"""
TORQUE_LINES = """Object.fromEntries([...document.querySelectorAll('figure[aria-label="Torque, joint 1"] .legend button')].map(
  (button) => [button.textContent.split(" ")[0], button.dataset.line]))"""
STATE = 'document.getElementById("state").dataset.state'
FAULTS = '[...document.querySelectorAll("[data-fault]")].map((node) => node.dataset.fault)'
LINK = 'document.getElementById("link").textContent'
KIND = 'document.getElementById("connection").dataset.kind'
AGE = 'document.getElementById("age").textContent'
WINDOW_S = 'document.getElementById("window").value'
SHOWN_TIME = 'document.getElementById("time").textContent'


def configuration(source, folder, seconds, fault_s, reset_s):
    """The demonstration with an emergency stop of a second. Its limits of lateness are the widest: this host has other work."""
    shipped = os.path.join(source, "firmware_app", "config")
    text = open(os.path.join(shipped, "adult.toml"), encoding="utf-8").read()
    text = re.sub(r'= "([a-z]+/[^"]+)"', lambda found: f'= "{shipped}/{found[1]}"', text)
    text = re.sub(r"duration_s = .*", f"duration_s = {seconds}", text)
    text = re.sub(r"overruns_tolerated = .*", "overruns_tolerated = 10", text)
    text = re.sub(r"missed_share_tolerated = .*", "missed_share_tolerated = 0.2", text)
    # Nor does the leg leave its limits as it swings freely, so that the inputs are healthy at the reset.
    for key, value in {"velocity_rad_s": [12, 12], "q_min_rad": [-6, -6], "q_max_rad": [6, 6]}.items():
        text = re.sub(rf"(?m)^{key} = .*", f"{key} = {value}", text)
    text = text.replace("[rig.operator]", f"[rig.operator]\nreset_at_s = {json.dumps(reset_s)}")
    bus = open(os.path.join(shipped, "can", "patella.toml"), encoding="utf-8").read()
    bus = bus.replace('"../../../', f'"{source}/')
    bus = re.sub(r"encoder_timeout_s = .*", "encoder_timeout_s = 0.02", re.sub(r"drive_timeout_s = .*", "drive_timeout_s = 0.05", bus))
    with open(os.path.join(folder, "bus.toml"), "w", encoding="utf-8") as file:
        file.write(bus)
    text = re.sub(r"(?m)^map = .*", f'map = "{folder}/bus.toml"', text)
    run = os.path.join(folder, "run.toml")
    with open(run, "w", encoding="utf-8") as file:
        file.write(text)
    faults = os.path.join(folder, "faults.toml")
    with open(faults, "w", encoding="utf-8") as file:
        file.write(f'[[fault]]\nkind = "emergency_stop"\ntime_s = {fault_s}\nduration_s = 1\n')
    return ["--config", run, "--faults", faults]


class Served:
    """patella view for a run, once it serves."""

    def __init__(self, patella, run, *more):
        deadline = time.monotonic() + 20
        while True:
            self.process = subprocess.Popen([patella, "view", run, *more, "--listen", "127.0.0.1:0"], stdout=subprocess.PIPE,
                                            stderr=subprocess.STDOUT, text=True)
            self.said = ""
            for line in self.process.stdout:  # how far it has read a long recording comes first
                self.said += line
                found = re.search(r"(http://127\.0\.0\.1:\d+)\n", line)
                if found:
                    self.address = found[1]
                    return
            self.process.wait()
            if time.monotonic() > deadline:
                raise RuntimeError(f"the server does not start: {self.said}")
            time.sleep(0.05)  # the run has not begun yet

    def end(self):
        self.process.terminate()
        self.process.wait()


def until(browser, expression, seconds, pause_s=0.02):
    """Waits for an expression to hold; says whether it did, and how long it took."""
    start = time.monotonic()
    while time.monotonic() - start < seconds:
        if browser.evaluate(expression):
            return True, time.monotonic() - start
        time.sleep(pause_s)
    return False, time.monotonic() - start


def event_times(run):
    """Time of each raised fault and of each state in a run, the first one."""
    times = {}
    for line in open(os.path.join(run, "events.log"), encoding="utf-8"):
        words = dict(word.split("=", 1) for word in line.split() if "=" in word)
        for key in ("raised", "state"):
            if key in words and "t_s" in words:
                times.setdefault((key, words[key]), float(words["t_s"]))
    return times


def look_at_live_run(browser, check, patella, arguments, folder, pictures):
    run = os.path.join(folder, "live")
    loop = subprocess.Popen([patella, "run", *arguments, "--clock", "monotonic", "--out", run], stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL)
    served = Served(patella, run)
    browser.width(WIDTHS["desktop"])
    browser.open(served.address + "/")
    check(until(browser, f"{LINK} === 'live'", 10)[0], "the page connects")
    if browser.evaluate('[...document.querySelectorAll(".frame")].some((frame) => frame.innerText.includes("without uPlot"))'):
        loop.kill()
        served.end()
        print("=" * 66 + "\nSKIPPED, the page was NOT looked at: it was built without uPlot (packages nodejs and npm)\n" + "=" * 66, file=sys.stderr)
        sys.exit(77)
    events = list(browser.events)
    browser.call("Network.disable")  # it would repeat every message here
    check_requests(check, events, served.address)
    check(until(browser, f"{STATE} === 'active'", 5)[0], f"the state is shown: {browser.evaluate(STATE)}")
    check(until(browser, f"{KIND} === 'good'", 2)[0], f"data are young: {browser.evaluate(LINK)}, {browser.evaluate(AGE)}")
    time.sleep(0.5)
    colours = browser.evaluate(DRAWN)
    check(len(colours) >= 10 and min(colours[:4]) > 10, f"the plots hold something: colours {colours}")
    saved = browser.evaluate(SAVED_AS)
    check(saved.startswith("patella_0.000_"), f"the window of a run that has just begun starts with it: {saved}")
    lines = browser.evaluate(TORQUE_LINES)
    check(len({lines.get(name) for name in ("drive", "command", "compensation")} - {None}) == 3,
          f"torques that lie upon each other have lines of their own: {lines}")

    served.process.send_signal(signal.SIGSTOP)
    old, _ = until(browser, f"{KIND} === 'bad'", 2)
    colour = browser.evaluate('getComputedStyle(document.getElementById("age")).color')
    check(old, f"data older than half a second are red: {browser.evaluate(AGE)}, {colour}")
    served.process.send_signal(signal.SIGCONT)
    check(until(browser, f"{KIND} === 'good'", 3)[0], "and not red once new ones come")

    seen, _ = until(browser, f"{FAULTS}.includes('emergency_stop')", 10)
    seen_at = time.time()
    frames = open(os.path.join(run, "frames.log"), encoding="utf-8").readline()
    start = float(re.match(r"\((\d+\.\d+)\)", frames)[1])
    words = browser.evaluate('document.getElementById("faults").innerText')
    check(seen and "Release the emergency stop" in words and "reset" in words, f"a fault is shown with its cause and the way out: {words!r}")
    gone, _ = until(browser, f"document.querySelector('[data-fault=emergency_stop]')?.innerText.includes('gone')", 4)
    check(gone, f"it stays latched when its cause is gone: {browser.evaluate(FAULTS)}")
    if pictures:
        take_picture(browser, WIDTHS["desktop"], os.path.join(pictures, "view_live.png"))
    left, _ = until(browser, f"{STATE} === 'ready' && {FAULTS}.length === 0", 10)
    check(left, f"reset leads out of it: {browser.evaluate(STATE)}, {browser.evaluate(FAULTS)}")
    # Once the run has ended, the page looks for another one.
    errors = [error for error in Browser.errors(browser.events + events) if "ERR_CONNECTION_REFUSED" not in str(error)]
    check(not errors, f"no error is on the console {errors or ''}")
    check(until(browser, f"{LINK} === 'the run has ended'", 8)[0], f"the end of the run is told: {browser.evaluate(LINK)}")
    foreign = browser.evaluate(f'performance.getEntriesByType("resource").filter(({{ name }}) => !name.startsWith("{served.address}")).map(({{ name }}) => name)')
    check(not foreign, f"nothing is asked of another host {foreign or ''}")
    loop.wait()
    served.process.wait()
    at = event_times(run)[("raised", "emergency_stop")]
    check(seen_at - (start + at) < 1.0, f"the fault of t = {at} s is seen {seen_at - (start + at):.3f} s later")
    browser.call("Network.enable")


def check_requests(check, events, address):
    origins = {re.match(r"\w+://[^/]+", request)[0].replace("ws://", "http://") for request in Browser.requests(events) if not request.startswith("data:")}
    check(origins == {address}, f"the page asks for nothing but its own server: {origins}")


def look_at_recording(browser, check, patella, arguments, folder, pictures):
    run = os.path.join(folder, "recorded")
    subprocess.run([patella, "run", *arguments, "--clock", "virtual", "--out", run], check=False, stdout=subprocess.DEVNULL)
    served = Served(patella, run)
    browser.width(WIDTHS["desktop"])
    browser.open(served.address + "/")
    check(until(browser, f"{LINK} === 'recorded run, not live' && {STATE} === 'active'", 10)[0], "a finished run is shown by the same page")
    scrub(browser, 39.0)
    check(until(browser, f"{SHOWN_TIME} === 't = 39.00 s'", 10)[0] and browser.evaluate(FAULTS) == [], "before the fault none is shown")
    check(browser.evaluate(STATE) == "active", "and the state is that of then")
    scrub(browser, 40.5)
    check(until(browser, f"{FAULTS}.includes('emergency_stop')", 10)[0], "scrubbed to behind the fault, it is shown")
    for width in WIDTHS.values():
        browser.width(width)
        check(browser.evaluate("document.documentElement.scrollWidth") <= width, f"at {width} px the page is no wider")
    if pictures:
        browser.evaluate("document.documentElement.dataset.theme !== 'dark' && document.getElementById('theme').click()")
        take_picture(browser, WIDTHS["tablet"], os.path.join(pictures, "view_tablet.png"))
        browser.evaluate("document.getElementById('theme').click()")
    browser.width(WIDTHS["desktop"])
    names = browser.call("Accessibility.getFullAXTree")["nodes"]
    browser.call("Accessibility.disable")
    nameless = [node["role"]["value"] for node in names if node.get("role", {}).get("value") in ("button", "slider", "combobox", "image", "figure")
                and not node.get("name", {}).get("value") and not node.get("ignored")]
    check(not nameless, f"everything that is used has a name for screen readers {nameless}")

    use_keys(browser, check)
    use_mouse(browser, check)
    look_at_files(browser, check, run, folder)
    look_at_speed(browser, check)
    errors = Browser.errors(browser.events)
    check(not errors, f"no error is on the console {errors or ''}")
    check_requests(check, browser.events, served.address)
    served.end()


def take_picture(browser, width, path):
    """All of the page: what is not in sight is not drawn."""
    browser.width(width, browser.evaluate("document.documentElement.scrollHeight") + 800)
    time.sleep(1.5)
    browser.width(width, browser.evaluate("document.body.scrollHeight"))
    time.sleep(1.5)
    browser.picture(path, whole=False)
    browser.width(width)


def look_at_log(browser, check, patella, arguments, folder):
    """The log of the recorded run, played to the loop."""
    log = os.path.join(folder, "recorded", "frames.log")
    refused = subprocess.run([patella, "view", log, "--listen", "127.0.0.1:0"], capture_output=True, text=True, check=False)
    check(refused.returncode == 1 and "--config" in refused.stderr, f"a log needs the loop's configuration: {refused.stderr.strip()}")
    served = Served(patella, log, *arguments[:2])
    browser.open(served.address + "/")
    shown, _ = until(browser, f"{LINK} === 'recorded run, not live' && {STATE} === 'active'", 10)
    check(shown, f"a log is shown as the loop takes it: {browser.evaluate(STATE)}")
    served.end()


def scrub(browser, time_s):
    browser.evaluate(f"""(() => {{
      const scrub = document.getElementById("scrub");
      scrub.value = {time_s};
      scrub.dispatchEvent(new Event("input"));
    }})()""")


def press(browser, key, code=0, text=None):
    for kind in ("keyDown", "keyUp"):
        browser.call("Input.dispatchKeyEvent", type=kind, key=key, windowsVirtualKeyCode=code, **({"text": text} if text and kind == "keyDown" else {}))


def use_keys(browser, check):
    browser.evaluate("document.activeElement.blur()")
    scrub(browser, 40.5)
    time.sleep(0.5)
    press(browser, "ArrowLeft", 37)
    check(until(browser, f"{SHOWN_TIME} === 't = 35.50 s'", 3)[0], f"the left arrow shows what was earlier: {browser.evaluate(SHOWN_TIME)}")
    press(browser, " ", 32)
    check(browser.evaluate('document.getElementById("pause").getAttribute("aria-pressed")') == "true", "space pauses")
    press(browser, "Escape", 27)
    check(browser.evaluate('document.getElementById("pause").getAttribute("aria-pressed")') == "false", "escape goes on")
    reached = []
    for _ in range(14):
        press(browser, "Tab", 9)
        reached.append(browser.evaluate("document.activeElement.id || document.activeElement.tagName"))
    check({"pause", "window", "zoom-in", "export-csv", "play", "scrub"} <= set(reached), f"the tab key reaches the controls: {reached}")


def use_mouse(browser, check):
    scrub(browser, 41.0)
    time.sleep(0.5)
    browser.evaluate("scrollTo(0, 0)")
    box = browser.evaluate('(() => { const b = document.querySelector(".u-over").getBoundingClientRect(); return [b.x, b.y, b.width, b.height]; })()')
    middle = box[1] + 0.5 * box[3]
    at = [box[0] + share * box[2] for share in (0.8, 0.85, 0.95)]
    browser.mouse("mousePressed", at[0], middle, button="left", buttons=1, clickCount=1)
    for x in at[1:]:
        browser.mouse("mouseMoved", x, middle, button="left", buttons=1)
    browser.mouse("mouseReleased", at[2], middle, button="left", clickCount=1)
    held = browser.evaluate('document.getElementById("pause").getAttribute("aria-pressed")')
    check(held == "true", "dragging over a plot zooms into it, and holds the window")


def look_at_files(browser, check, run, folder):
    """What the two buttons save of the window that was dragged over: 39 to 40.5 s of 41 s, thereabouts."""
    saved = os.path.join(folder, "saved")
    os.makedirs(saved)
    browser.call("Page.setDownloadBehavior", behavior="allow", downloadPath=saved)
    for button in ("export-csv", "export-png"):
        browser.evaluate(f'document.getElementById("{button}").click()')
    deadline = time.monotonic() + 10
    while time.monotonic() < deadline and sorted(os.path.splitext(name)[1] for name in os.listdir(saved)) != [".csv", ".png"]:
        time.sleep(0.1)
    files = {os.path.splitext(name)[1]: os.path.join(saved, name) for name in os.listdir(saved)}
    with open(files[".csv"], encoding="utf-8") as file:
        header, *rows = list(csv.reader(file))
    with open(os.path.join(run, "ticks.csv"), encoding="utf-8") as file:
        recorded_header, *recorded = list(csv.reader(file))
    by_time = {float(row[0]): row for row in recorded}
    number = lambda cell: None if cell == "" else float(cell)
    same = all(list(map(number, row)) == list(map(number, by_time.get(float(row[0]), []))) for row in rows)
    span = float(rows[-1][0]) - float(rows[0][0])
    check(header == recorded_header and same and 1.3 < span < 1.7, f"the CSV of the window has {len(rows)} ticks, equal to ticks.csv to the last bit")
    with open(files[".png"], "rb") as file:
        png = file.read()
    check(png.startswith(b"\x89PNG") and int.from_bytes(png[16:20], "big") > 700 and len(png) > 20_000, f"the picture is saved, {len(png)} bytes")


# Moves the slider for some seconds, to and fro, as often as the screen turns.
SCRUB = """new Promise((done) => {
  const scrub = document.getElementById("scrub");
  const start = performance.now();
  const turn = (now) => {
    if (now - start > 4000) return done();
    scrub.value = 61 + Math.sin((now - start) / 500);
    scrub.dispatchEvent(new Event("input"));
    requestAnimationFrame(turn);
  };
  requestAnimationFrame(turn);
})"""
# Of all plots together: each line has its least and its largest value in a column, where it drew 60,000 without.
MOST_POINTS_PER_COLUMN = 8
COUNT_POINTS = """(() => {
  window.drawnPoints = 0;
  for (const type of [Path2D, CanvasRenderingContext2D]) {
    const lineTo = type.prototype.lineTo;
    type.prototype.lineTo = function (...place) {
      ++window.drawnPoints;
      return lineTo.apply(this, place);
    };
  }
})()"""
PICTURES = 'Number(document.getElementById("speed").dataset.pictures)'


def look_at_speed(browser, check):
    """A minute at 1 kHz that moves."""
    press(browser, "Escape", 27)
    browser.evaluate("""(() => {
      const select = document.getElementById("window");
      select.value = "60";
      select.dispatchEvent(new Event("change"));
    })()""")
    scrub(browser, 62.5)
    time.sleep(3)
    browser.call("Performance.enable")
    # How long a picture takes depends on what else the host does; how much it draws does not.
    browser.evaluate(COUNT_POINTS)
    used, pictures = processor_s(browser), browser.evaluate(PICTURES)
    browser.evaluate(SCRUB)
    used, pictures = processor_s(browser) - used, browser.evaluate(PICTURES) - pictures
    points = browser.evaluate("window.drawnPoints") / max(1, pictures)
    pixels = browser.evaluate("[...document.querySelectorAll('canvas')].reduce((sum, canvas) => sum + canvas.width, 0)")
    check(pictures > 0 and 0 < points < MOST_POINTS_PER_COLUMN * pixels,
          f"with 60 s at 1 kHz in the window a picture has {points:.0f} points on {pixels} columns of pixels; here it took "
          f"{1e3 * used / max(1, pictures):.1f} ms of a processor")
    browser.evaluate('document.getElementById("play").click()')
    moved, _ = until(browser, f"Number(/[\\d.]+/.exec({SHOWN_TIME})[0]) > 64", 15)
    check(moved, f"played, time goes on: {browser.evaluate(SHOWN_TIME)}")
    browser.evaluate('document.getElementById("play").click()')


def processor_s(browser):
    """Of the page's process, since it began."""
    return next(metric["value"] for metric in browser.call("Performance.getMetrics")["metrics"] if metric["name"] == "ProcessTime")


def heap(browser):
    browser.call("HeapProfiler.collectGarbage")
    usage = browser.call("Runtime.getHeapUsage")
    return (usage["usedSize"] + usage.get("backingStorageSize", 0)) / 1e6


def look_at_memory(browser, check, patella, source, folder, seconds, rate_Hz):
    """The page stays open while virtual time goes by, as fast as the loop can; twice what the history holds, then as much again."""
    arguments = configuration(source, folder, seconds, 1e6, [])
    run = os.path.join(folder, "long")
    loop = subprocess.Popen([patella, "run", *arguments[:2], "--clock", "virtual", "--rate", str(rate_Hz), "--out", run],
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    served = Served(patella, run)
    browser.call("Network.disable")
    browser.open(served.address + "/")
    newest = f"Number(/[\\d.]+/.exec({SHOWN_TIME})?.[0] ?? 0)"
    sizes = []
    for share in (0.3, 0.6, 0.95):
        until(browser, f"{newest} >= {share * seconds} || {LINK} === 'the run has ended'", 3600, 0.25)
        sizes.append((browser.evaluate(newest), heap(browser)))
    check(sizes[-1][0] > 0.9 * seconds, f"the page was open until t = {sizes[-1][0]} s")
    check(sizes[-1][1] < sizes[0][1] + 8, "memory does not grow: " + ", ".join(f"{size:.1f} MB at {at:.0f} s" for at, size in sizes))
    loop.wait()
    served.process.wait()


def main():
    patella, source = sys.argv[1:3]
    hour = sys.argv[3:] == ["--hour"]
    pictures = sys.argv[3] if len(sys.argv) > 3 and not hour else None
    chromium = chromium_or_skip("the page of patella view")
    check = Check()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        browser = Browser(chromium, os.path.join(folder, "profile"), 3600 if hour else 220)
        try:
            browser.attach()
            if hour:
                look_at_memory(browser, check, patella, source, folder, 3600, 200)
            else:
                for attempt in range(ATTEMPTS):
                    live = os.path.join(folder, f"live-{attempt}")
                    os.makedirs(live)
                    later_s = 6.0 if pictures else 0.0  # a picture takes its time, and is to show the fault
                    arguments = configuration(source, live, LIVE_S + later_s, FAULT_S, [RESET_S + later_s, RESET_S + later_s + 1])
                    this_time = Check()
                    look_at_live_run(browser, this_time, patella, arguments, live, pictures)
                    if this_time.failures == 0:
                        break
                    print(f"run {attempt + 1} of {ATTEMPTS} failed; another program may have had the processor")
                check.failures += this_time.failures
                look_at_recording(browser, check, patella, configuration(source, folder, RECORDED_S, RECORDED_FAULT_S, [45.0]), folder, pictures)
                look_at_log(browser, check, patella, configuration(source, folder, RECORDED_S, 1e6, []), folder)
                look_at_memory(browser, check, patella, source, folder, 300, 200)
        finally:
            browser.close()
    return 1 if check.failures else 0


if __name__ == "__main__":
    sys.exit(main())
