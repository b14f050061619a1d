// What is told in words: state, faults with their cause and the way out, counters, events.
const BUS_BITS_S = 1e6;
const KEPT_EVENTS = 200;
const SHOWN_EVENTS = 60;

const byId = (id) => document.getElementById(id);

function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** "t_s=1.5 state=fault raised=encoder_stale" in parts. */
function parseEvent(line) {
  const event = { time: NaN, state: "", raised: [], cleared: [], warnings: [], over: [], missed: 0, line };
  for (const word of line.split(" ")) {
    const [key, value] = word.split("=");
    if (key === "t_s") event.time = Number(value);
    else if (key === "state") event.state = value;
    else if (key === "raised") event.raised.push(value);
    else if (key === "cleared") event.cleared.push(value);
    else if (key === "warning") event.warnings.push(value);
    else if (key === "no_longer") event.over.push(value);
    else if (key === "missed_periods") event.missed = Number(value);
  }
  return event;
}

class Panels {
  constructor(goTo) {
    this.goTo = goTo;
    this.faultsShown = "";
    this.counters = new Map();
    this.listed = null;
  }
  showState(name) {
    const node = byId("state");
    if (node.dataset.state === name) return;
    node.dataset.state = name;
    setText(node.querySelector("strong"), name);
    document.title = name === "fault" || name === "limited" ? `${name.toUpperCase()} – Patella` : `${name} – Patella`;
  }
  /** `faults`: [name, time or NaN], in the order in which they came. */
  showFaults(faults) {
    const key = JSON.stringify(faults);
    if (key === this.faultsShown) return;
    this.faultsShown = key;
    byId("fault-card").classList.toggle("latched", faults.length > 0);
    if (faults.length === 0) {
      byId("faults").replaceChildren(element("p", { class: "none" }, "none"));
      return;
    }
    byId("faults").replaceChildren(...faults.map(([name, time], i) => {
      const [cause, wayOut] = FAULTS[name] ?? ["A fault that this page does not know.", "See the log of the run."];
      const when = Number.isNaN(time) ? "" : `, t = ${time.toFixed(3)} s`;
      return element("div", { class: "fault", "data-fault": name }, element("p", {}, element("strong", {}, name), when, i === 0 && faults.length > 1 ? " (first)" : ""),
        element("p", { class: "cause" }, cause), element("p", { class: "way-out" }, wayOut));
    }), element("p", { class: "way-out reset" }, RESET));
  }
  count(name, text) {
    if (!this.counters.has(name)) {
      const value = element("dd", {}, "–");
      byId("counters").append(element("dt", {}, name), value);
      this.counters.set(name, value);
    }
    setText(this.counters.get(name), text);
  }
  showTiming(timing) {
    const bits_s = timing.frame_bits;
    this.count("Ticks in the last second", String(timing.ticks));
    this.count("Missed periods, last second", String(timing.missed_periods));
    this.count("Frames in the last second", String(timing.frames));
    this.count("Bus, without stuff bits", `${Math.round(1e-3 * bits_s)} kbit/s`);
    this.count("Bus load at 1 Mbit/s", `${((100 * bits_s) / BUS_BITS_S).toFixed(0)} %`);
  }
  showEvents(events, until) {
    const shown = events.filter(({ time }) => !(time > until)).slice(-SHOWN_EVENTS).reverse();
    const key = shown.length === 0 ? "" : `${shown.length} ${shown[0].line}`;
    if (key === this.listed) return;
    this.listed = key;
    byId("events").replaceChildren(...shown.map((event) => {
      const kind = event.raised.length > 0 ? "raised" : event.warnings.length > 0 || event.missed > 0 ? "warned" : "";
      const button = element("button", { type: "button", class: kind, title: "Show this moment" }, event.line.replaceAll("=", " ").replace("t_s ", "t = "));
      button.onclick = () => this.goTo(event.time);
      return element("li", {}, button);
    }));
  }
}
