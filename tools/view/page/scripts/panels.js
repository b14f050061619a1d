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

/**
 * Faults that are latched, [name, time, whether it is still there], the first cause first: those that came since torque was
 * stopped. Ticks say what is there now, and not what is latched. Before all inputs were complete, what is there latches nothing.
 */
function latchedFaults(events, state, present) {
  const latched = new Map();
  for (const event of events) {
    if (event.state !== "fault" && event.state !== "limited") latched.clear();
    else for (const name of event.raised) if (!latched.has(name)) latched.set(name, event.time);
  }
  if (state !== "fault" && state !== "limited") return [];
  for (const name of present) if (!latched.has(name)) latched.set(name, NaN);
  return [...latched].map(([name, time]) => [name, time, present.includes(name)]);
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
  /** `faults` as latchedFaults() has them; NaN for a time before the page was opened. */
  showFaults(faults, stopped) {
    const key = JSON.stringify([faults, stopped]);
    if (key === this.faultsShown) return;
    this.faultsShown = key;
    byId("fault-card").classList.toggle("latched", stopped);
    if (!stopped) {
      byId("faults").replaceChildren(element("p", { class: "none" }, "none"));
      return;
    }
    const unknown = faults.length > 0 ? [] : [element("p", {}, "The cause came before this page was opened: see events.log of the run.")];
    byId("faults").replaceChildren(...unknown, ...faults.map(([name, time, present], i) => {
      const [cause, wayOut] = FAULTS[name] ?? ["A fault that this page does not know.", "See the log of the run."];
      const when = Number.isNaN(time) ? "" : `, t = ${time.toFixed(3)} s`;
      return element("div", { class: "fault", "data-fault": name }, element("p", {}, element("strong", {}, name), when, i === 0 && faults.length > 1 ? ", first" : "", present ? ", still there" : ", gone"),
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
  showEvents(events) {
    const shown = events.slice(-SHOWN_EVENTS).reverse();
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
