#!/usr/bin/env python3
"""Opens the page of a diagnosis in headless Chromium and uses it as a reader would.

    report_in_browser.py PAGE.html | PROGRAM [PICTURE-FOLDER]

PROGRAM is run with the name of the page that it is to write. Pictures of what was seen are left in PICTURE-FOLDER.
Exit status 77 where there is no Chromium.
"""
import os
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "support"))
from browser import Browser, Check, chromium_or_skip

TIMEOUT_S = 60
WIDTHS = (1280, 800)


# Words of cells that stand on more than one line. A sum of 64 characters may give way to what stands beside it.
BROKEN_WORDS = """(() => {
  const broken = [];
  for (const cell of document.querySelectorAll("td, th")) {
    const walker = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
    for (let node = walker.nextNode(); node; node = walker.nextNode())
      for (const word of node.data.matchAll(/(?<![\\p{L}\\p{N}_.])[\\p{L}\\p{N}_.]{1,40}(?![\\p{L}\\p{N}_.])/gu)) {
        const range = document.createRange();
        range.setStart(node, word.index);
        range.setEnd(node, word.index + word[0].length);
        if (new Set([...range.getClientRects()].map((box) => Math.round(box.top))).size > 1) broken.push(word[0]);
      }
  }
  return broken;
})()"""

CHARTS = 'document.querySelectorAll("figure.live .chart")'
X_TICKS = f'[...{CHARTS}[0].querySelectorAll(".x.tick")].map((tick) => Number(tick.textContent))'
Y_TICKS = f'[...{CHARTS}[0].querySelectorAll(".y.tick")].map((tick) => Number(tick.textContent))'


def look_at_rest(browser, check, pictures):
    for width in WIDTHS:
        browser.width(width)
        broken = browser.evaluate(BROKEN_WORDS)
        check(not broken, f"at {width} px no column of a table is narrower than its words {broken[:5] or ''}")
        check(browser.evaluate("document.documentElement.scrollWidth") <= width, f"at {width} px the page is no wider")
        if pictures:
            browser.picture(os.path.join(pictures, f"page_{width}.png"))


def look_into(browser, check, pictures):
    browser.width(WIDTHS[0])
    count = browser.evaluate("document.querySelectorAll('script.curves').length")
    check(count > 0 and browser.evaluate(f"{CHARTS}.length") == count, f"all {count} figures with data can be looked into")
    browser.evaluate(f"{CHARTS}[0].scrollIntoView({{block: 'center'}})")
    box = browser.evaluate(f"(() => {{ const b = {CHARTS}[0].getBoundingClientRect(); return [b.x, b.y, b.width, b.height]; }})()")
    middle = box[1] + 0.5 * box[3]
    at = [box[0] + share * box[2] for share in (0.3, 0.4, 0.5)]
    names = browser.evaluate('JSON.parse(document.querySelector("script.curves").textContent).series.map((s) => s.label)')

    check(not browser.evaluate("document.querySelector('.values.shown')"), "no values are shown without a cursor")
    browser.mouse("mouseMoved", at[1], middle)
    values = browser.evaluate("document.querySelector('.values.shown')?.innerText ?? ''").splitlines()
    check(values and values[0].startswith("time"), f"the cursor's time is shown: {values[:1]}")
    for name, line in zip(names, values[1:] + [""] * len(names)):
        number, _, unit = line.removeprefix(name).strip().partition(" ")
        shown = line.startswith(name) and number not in ("", "–") and abs(float(number)) < 1e6 and unit
        check(shown, f"a curve's value is shown with its unit: '{line}'")
    check(browser.evaluate("""(() => {
      const values = document.querySelector(".values.shown").getBoundingClientRect();
      const chart = document.querySelector("figure.live .chart").getBoundingClientRect();
      return values.top >= chart.top && values.bottom <= chart.bottom && values.left >= chart.left && values.right <= chart.right;
    })()"""), "the values stand inside the picture")
    if pictures:
        browser.picture(os.path.join(pictures, "values.png"), whole=False)

    whole = browser.evaluate(X_TICKS)
    whole_y = browser.evaluate(Y_TICKS)
    browser.mouse("mousePressed", at[0], middle, button="left", buttons=1, clickCount=1)
    browser.mouse("mouseMoved", at[1], middle, button="left", buttons=1)
    check(browser.evaluate("document.querySelector('.chart .selection') !== null"), "what is dragged over is marked")
    browser.mouse("mouseMoved", at[2], middle, button="left", buttons=1)
    browser.mouse("mouseReleased", at[2], middle, button="left", clickCount=1)
    near = browser.evaluate(X_TICKS)
    check(min(near) > min(whole) and max(near) < max(whole), f"dragging zooms: {whole[0]}…{whole[-1]} to {near[0]}…{near[-1]}")
    if pictures:
        browser.picture(os.path.join(pictures, "zoom.png"), whole=False)
    for count in (1, 2):
        browser.mouse("mousePressed", at[1], middle, button="left", buttons=1, clickCount=count)
        browser.mouse("mouseReleased", at[1], middle, button="left", clickCount=count)
    check(browser.evaluate(X_TICKS) == whole and browser.evaluate(Y_TICKS) == whole_y, "a double click shows the whole again")


def look_without_scripts(browser, check, address):
    browser.open(address, scripts=False)
    document = browser.call("DOM.getDocument")["root"]["nodeId"]
    figures = browser.call("DOM.querySelectorAll", nodeId=document, selector="figure")["nodeIds"]
    drawn = browser.call("DOM.querySelectorAll", nodeId=document, selector="figure > svg:not(.chart)")["nodeIds"]
    seen = 0
    for node in drawn:
        box = browser.call("DOM.getBoxModel", nodeId=node)["model"]
        seen += box["width"] > 100 and box["height"] > 50
    check(len(figures) > 0 and seen == len(figures), f"without scripts all {len(figures)} figures are pictures ({seen} are)")


def run(program, page, pictures):
    check = Check()
    address = "file://" + os.path.abspath(page)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(program, profile, TIMEOUT_S)
        try:
            browser.attach()
            browser.open(address)
            look_at_rest(browser, check, pictures)
            look_into(browser, check, pictures)
            time.sleep(0.2)  # for requests that a timer might send
            browser.evaluate("1")
            events = list(browser.events)
            look_without_scripts(browser, check, address)
        finally:
            browser.close()
    requests = Browser.requests(events)
    foreign = [request for request in requests if request != address]
    check(address in requests and not foreign, f"the page asks for nothing but itself {foreign or ''}")
    errors = Browser.errors(events)
    check(not errors, f"no error is on the console {errors or ''}")
    return check.failures


def main():
    chromium = chromium_or_skip("the report")
    pictures = sys.argv[2] if len(sys.argv) > 2 else None
    if sys.argv[1].endswith(".html"):
        return 1 if run(chromium, sys.argv[1], pictures) else 0
    with tempfile.TemporaryDirectory() as folder:
        page = os.path.join(folder, "report.html")
        subprocess.run([sys.argv[1], page], check=True)
        return 1 if run(chromium, page, pictures) else 0


if __name__ == "__main__":
    sys.exit(main())
