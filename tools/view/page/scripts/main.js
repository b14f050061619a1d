// The run that is shown: takes messages from its source, and draws what the view wants to see of them.
const TOO_OLD_MS = 500;
const TELL_MS = 200;
const SHORTEST_PICTURE_MS = 24; // every second turn of a screen with 60 a second
const SHORTEST_WINDOW_S = 1;
const OTHER_CLOCK_MS = 86_400_000; // stamps further off than that are of virtual time

class Run {
  held = null; // the window that stays, where time does not go on: { from, to }
  length = 10; // of the window, s
  events = [];
  timings = [];
  cursor = null;
  dirty = true;
  nextPicture = 0;
  drawn = null; // when the picture before this turn began
  arrived = NaN; // of the newest tick, on this page's clock
  lag = { least: Infinity, newest: 0 }; // arrival less stamp
  pictures = { all: 0, count: 0, ms: 0, since: performance.now() };

  constructor() {
    this.panels = new Panels((time) => this.goTo(time));
    this.live = document.documentElement.dataset.kind === "live";
    this.controls();
    this.source = this.live ? new LiveSource(this) : new RecordingSource(this);
    setInterval(() => this.tell(), TELL_MS);
    requestAnimationFrame((now) => this.picture(now));
  }

  // What the source tells.
  begin({ name, metadata }) {
    setText(byId("name"), name);
    this.columns = metadata.columns.split(",");
  }
  advertised(channels) {
    const byTopic = new Map(channels.map((channel) => [channel.topic, channel]));
    const ticks = byTopic.get("/patella/tick");
    this.tickChannel = ticks.id;
    this.decoders = new Map(["/patella/events", "/patella/timing"].map((topic) => [byTopic.get(topic).id, new Decoder(byTopic.get(topic).schema)]));
    this.eventChannel = byTopic.get("/patella/events").id;
    const definition = ticks.schema + this.columns;
    if (definition === this.definition) return; // connected anew
    this.definition = definition;
    this.ticks = new TickDecoder(ticks.schema, this.columns);
    this.row = new Float64Array(this.columns.length).fill(NaN);
    this.history = new History(this.columns);
    byId("leg").closest(".card").hidden = !Leg.shows(this.history);
    this.leg = new Leg(byId("leg"), this.history);
    this.plots();
  }
  message(channel, stamp_ns, view, start) {
    if (channel === this.tickChannel) {
      this.ticks.decode(view, start, this.row);
      this.arrived = performance.now();
      this.lag.newest = Date.now() - 1e-6 * stamp_ns;
      this.lag.least = Math.min(this.lag.least, this.lag.newest);
      if (this.live && this.row[this.history.time] <= this.newest) this.forgetAll();
      this.newest = this.row[this.history.time];
      if (!this.live || !this.held) this.history.append(this.row);
    } else if (channel === this.eventChannel) {
      const event = parseEvent(this.decoders.get(channel).decode(view, start).msg);
      if (this.live) this.events = [...this.events.slice(1 - KEPT_EVENTS), event];
      if (this.live && event.raised.length > 0) this.tell();
    } else if (this.decoders.has(channel)) {
      const timing = this.decoders.get(channel).decode(view, start);
      this.timings = [...this.timings.filter(({ t_s }) => t_s < timing.t_s && t_s > timing.t_s - 70), timing];
    }
    this.dirty = true;
  }
  connection(kind, words) {
    const node = byId("connection");
    node.dataset.link = kind;
    setText(byId("link"), words);
    this.tellAge();
  }
  note(words) {
    setText(byId("notes"), words);
  }
  recordedEvents(events) {
    this.events = events.map(({ line }) => parseEvent(line));
  }
  /** A run began anew: nothing of the one before holds. */
  forgetAll() {
    this.history.clear();
    this.events = [];
    this.timings = [];
    this.lag = { least: Infinity, newest: 0 };
    this.release();
  }
  forget() {
    this.history.clear();
    this.timings = [];
  }
  /** Seconds that the page can keep. */
  span() {
    return this.history.period === Infinity ? Infinity : CAPACITY * this.history.period - 3;
  }
  opened(player) {
    const scrub = byId("scrub");
    byId("player").hidden = false;
    [scrub.min, scrub.max] = [player.start_s, player.end_s];
    scrub.oninput = () => {
      this.held = null;
      player.seek(Number(scrub.value));
    };
    byId("play").onclick = () => player.play(!player.playing);
  }
  moved() {
    byId("scrub").value = this.source.at;
    setText(byId("scrub-time"), `${this.source.at.toFixed(2)} of ${this.source.end_s.toFixed(2)} s`);
    this.dirty = true;
  }
  played(on) {
    setText(byId("play"), on ? "Stop" : "Play");
    byId("play").setAttribute("aria-pressed", String(on));
  }

  // The view.
  window() {
    if (this.held) return this.held;
    const to = this.live ? this.history.newest : this.source.at;
    // Before the run there is nothing to see; a run that has just begun has a second of its own.
    const start = this.live ? 0 : this.source.start_s;
    return { from: Math.max(to - this.length, start), to: Math.max(to, start + SHORTEST_WINDOW_S) };
  }
  hold(from, to) {
    this.held = { from, to };
    if (!this.live) this.source.play(false);
    this.showHeld();
  }
  release() {
    this.held = null;
    this.showHeld();
  }
  showHeld() {
    const pause = byId("pause");
    pause.setAttribute("aria-pressed", String(this.held !== null));
    setText(pause, this.held ? "Go on" : "Pause");
    if (this.live) this.note(this.held ? "Paused: state and faults go on, and ticks that come now are not kept for the plots." : "");
    this.dirty = true;
  }
  move(share) {
    const { from, to } = this.window();
    const by = share * (to - from);
    if (!this.live && !this.held) this.source.seek(this.source.at + by);
    else this.hold(from + by, to + by);
  }
  zoom(factor) {
    const { from, to } = this.window();
    const middle = 0.5 * (from + to);
    const half = 0.5 * factor * (to - from);
    if (half * 2 <= 60 && half > 0.002) this.hold(middle - half, middle + half);
  }
  goTo(time) {
    if (!this.live) this.source.seek(time + 0.5 * this.length);
    this.hold(time - 0.5 * this.length, time + 0.5 * this.length);
  }
  marks() {
    return this.events.flatMap((event, i) => {
      const raised = event.raised.length > 0;
      return raised || (i > 0 && event.state !== this.events[i - 1].state) ? [{ time: event.time, raised }] : [];
    });
  }

  // Controls.
  controls() {
    const on = (id, act) => (byId(id).onclick = act);
    const pause = () => {
      const { from, to } = this.window();
      if (this.held) this.release();
      else this.hold(from, to);
    };
    const acts = { pause, earlier: () => this.move(-0.5), later: () => this.move(0.5), "zoom-in": () => this.zoom(0.5), "zoom-out": () => this.zoom(2) };
    for (const [id, act] of Object.entries(acts)) on(id, () => this.history && act());
    byId("window").onchange = ({ target }) => {
      this.length = Number(target.value);
      this.release();
    };
    on("export-csv", () => {
      const { from, to } = this.window();
      save(new Blob([csvOf(this.history, from, to)], { type: "text/csv" }), `patella_${from.toFixed(3)}_${to.toFixed(3)}.csv`);
    });
    on("export-png", async () => {
      const { from, to } = this.window();
      this.draw(true);
      const heading = `${byId("name").textContent}, t = ${from.toFixed(3)} to ${to.toFixed(3)} s`;
      save(await pictureOf(this.charts, heading), `patella_${from.toFixed(3)}_${to.toFixed(3)}.png`);
    });
    const theme = (dark) => {
      document.documentElement.dataset.theme = dark ? "dark" : "light";
      colours.clear();
      this.dirty = true;
    };
    const wish = matchMedia("(prefers-color-scheme: dark)");
    wish.onchange = () => theme(wish.matches);
    theme(wish.matches);
    on("theme", () => theme(document.documentElement.dataset.theme !== "dark"));
    const keys = { " ": "pause", ArrowLeft: "earlier", ArrowRight: "later", "+": "zoom-in", "-": "zoom-out" };
    document.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey || event.target.matches("select, input")) return;
      if (event.key === "Escape") this.release();
      else if (keys[event.key] && !(event.key === " " && event.target.matches("button, summary"))) byId(keys[event.key]).click();
      else return;
      event.preventDefault();
    });
  }

  // Pictures.
  plots() {
    this.charts = plotsOf(this.history).map((plot) => new Chart(plot, this.history, this));
    this.histograms = [new Histogram("Wake-up after its time", "wakeup"), new Histogram("Execution of a tick", "execution")];
    this.all = [...this.charts, ...this.histograms];
    byId("plots").replaceChildren(...this.all.map(({ figure }) => figure));
    const seen = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) this.all.find(({ figure }) => figure === target).visible = isIntersecting;
      this.dirty = true;
    });
    const sized = new ResizeObserver(() => {
      for (const chart of this.all) chart.resize();
      this.dirty = true;
    });
    for (const chart of this.all) {
      chart.open();
      seen.observe(chart.figure);
      sized.observe(chart.frame);
      chart.plot?.over.addEventListener("mousemove", ({ offsetX }) => (this.cursor = chart.plot.posToVal(offsetX, "x")));
      chart.plot?.over.addEventListener("mouseleave", () => (this.cursor = null));
    }
  }
  picture(now) {
    requestAnimationFrame((next) => this.picture(next));
    if (!this.live) this.source.advance(now);
    const before = performance.now();
    // What the last picture took with all that the browser did to show it. Time is left for messages and hands, however slow
    // the machine.
    if (this.drawn !== null) this.nextPicture = Math.max(this.nextPicture, this.drawn + 1.5 * (before - this.drawn));
    this.drawn = null;
    if (!this.history || !this.dirty || before < this.nextPicture) return;
    this.dirty = false;
    this.draw(false);
    this.drawn = before;
    const took = performance.now() - before;
    this.nextPicture = before + Math.max(2 * took, SHORTEST_PICTURE_MS);
    this.pictures.ms += took;
    ++this.pictures.count;
    ++this.pictures.all;
  }
  draw(everything) {
    const { from, to } = this.window();
    if (Number.isNaN(from)) return;
    // Two values a bucket: one a pixel.
    const shared = this.history.buckets(from, to, Math.max(this.charts[0].frame.clientWidth / 2, 100));
    for (const chart of this.charts) if (chart.visible || everything) chart.draw(from, to, shared);
    this.leg.draw(this.current());
  }
  /** The newest row of a live run; of a recording, the tick at the player's time. */
  current() {
    if (this.live || this.history.end === 0) return this.row;
    const n = Math.max(Math.min(this.history.find(this.source.at + 1e-9), this.history.end) - 1, this.history.begin);
    return Float64Array.from(this.columns, (_name, i) => this.history.value(i, n));
  }

  // Words.
  tell() {
    this.tellAge();
    this.tellSpeed();
    if (!this.history || this.history.end === 0) return;
    const row = this.current();
    const time = row[this.history.time];
    const at = (name) => row[this.history.indexOf.get(name)];
    setText(byId("time"), `t = ${time.toFixed(2)} s`);
    this.leg.tell(row);
    const state = this.ticks.states.get(at("state")) ?? "unknown";
    this.panels.showState(state);
    const present = this.ticks.faults.filter(([bit]) => (at("faults") & bit) !== 0).map(([, name]) => name);
    const before = this.events.filter((event) => event.time <= time);
    this.panels.showFaults(latchedFaults(before, state, present), state === "fault" || state === "limited");
    this.panels.showEvents(before);
    const { from, to } = this.window();
    const timings = this.timings.filter(({ t_s }) => t_s + 1 > from && t_s < to);
    if (timings.length > 0) this.panels.showTiming(timings.at(-1));
    for (const histogram of this.histograms) if (histogram.visible) histogram.draw(timings);
    const warnings = new Set();
    for (const event of before) {
      event.warnings.forEach((name) => warnings.add(name));
      event.over.forEach((name) => warnings.delete(name));
    }
    this.panels.count("Warnings", [...warnings].join(", ") || "none");
    if (!Number.isNaN(at("latency_us"))) this.panels.count("Sensor to command", `${at("latency_us").toFixed(0)} µs`);
    const n = this.cursor === null ? null : Math.min(this.history.find(this.cursor), this.history.end - 1);
    for (const chart of this.charts) if (chart.visible) chart.tell((i) => (n === null ? row[i] : this.history.value(i, n)));
  }
  /** Since the newest tick came, and how much longer than the fastest it was on its way. */
  tellAge() {
    const node = byId("connection");
    const link = node.dataset.link;
    if (!this.live) {
      node.dataset.kind = link === "lost" ? "bad" : "ended";
      return;
    }
    const behind = Math.abs(this.lag.newest) > OTHER_CLOCK_MS ? 0 : this.lag.newest - this.lag.least;
    const age = performance.now() - this.arrived + behind;
    const old = !(age <= TOO_OLD_MS);
    node.dataset.kind = link === "ended" ? "ended" : link === "open" && !old ? "good" : "bad";
    setText(byId("age"), Number.isNaN(age) ? "no data yet" : `data ${old ? (1e-3 * age).toFixed(1) : "< 0.5"} s old`);
  }
  tellSpeed() {
    const now = performance.now();
    const { all, count, ms, since } = this.pictures;
    byId("speed").dataset.pictures = all;
    if (now - since < 1000) return;
    setText(byId("speed"), count === 0 ? "" : `${((1e3 * count) / (now - since)).toFixed(0)} pictures a second, ${(ms / count).toFixed(1)} ms each`);
    this.pictures = { all, count: 0, ms: 0, since: now };
  }
}

new Run();
