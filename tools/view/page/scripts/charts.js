// Plots over time: which columns each shows, and how. Without uPlot the values remain, as text.
const CAN_PLOT = typeof uPlot !== "undefined";
const DEGREES = 180 / Math.PI;
const HEIGHT = 190;
const LARGEST_DASHED = 64; // ticks a bucket
const DASHES = { dash: [6, 4], dot: [2, 3] };

/** Numbers of the joints that the run has. */
function jointsOf(history) {
  return [1, 2, 3, 4, 5, 6, 7, 8].filter((joint) => history.indexOf.has(`q${joint}_rad`));
}

/**
 * Curves of a plot: column, words, and how its line is told from others that it lies upon: "wide" for what they lie upon,
 * "dash" for what is wished rather than measured, "dot" for what is added to it.
 */
function plotsOf(history) {
  const joints = jointsOf(history);
  const plots = [];
  const row = (title, unit, factor, curves) => {
    for (const joint of joints) plots.push({ title: `${title}, joint ${joint}`, unit, factor, curves: curves(joint) });
  };
  row("Angle", "°", DEGREES, (j) => [[`q${j}_rad`, "measured"], [`ref${j}_rad`, "reference", "dash"]]);
  row("Torque", "N·m", 1, (j) => [
    [`tau${j}_Nm`, "drive", "wide"], [`tau_cmd${j}_Nm`, "command", "dash"], [`tau_gravity${j}_Nm`, "gravity"], [`tau_model${j}_Nm`, "model"],
    [`tau_emg${j}_Nm`, "EMG"], [`tau_impedance${j}_Nm`, "impedance"], [`tau_compensation${j}_Nm`, "compensation", "dot"],
  ]);
  row("Unknown acceleration f_u", "rad/s²", 1, (j) => [
    [`f_s_filtered${j}_rad_s2`, "sampler"], [`f_network${j}_rad_s2`, "network"], [`f_true${j}_rad_s2`, "true", "dash"],
  ]);
  const channels = [1, 2, 3, 4];
  plots.push({ title: "EMG", unit: "mV", factor: 1, curves: channels.map((i) => [`emg${i}_mV`, `channel ${i}`]) });
  plots.push({ title: "Activation", unit: "0 rest to 1 full", factor: 1, curves: channels.map((i) => [`activation${i}`, `channel ${i}`]) });
  for (const plot of plots) plot.curves = plot.curves.filter(([column]) => history.indexOf.has(column));
  return plots.filter(({ curves }) => curves.length > 0);
}

/** A colour of the page; they are asked for a hundred times a picture. */
const colours = new Map();
function styleOf(name) {
  if (!colours.has(name)) colours.set(name, getComputedStyle(document.documentElement).getPropertyValue(name).trim());
  return colours.get(name);
}

function element(name, attributes = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

/** Axes of every plot here, in the colours of the page. */
function axes(unit, bottom) {
  const common = {
    stroke: () => styleOf("--weak"),
    grid: { stroke: () => styleOf("--grid"), width: 1 },
    ticks: { stroke: () => styleOf("--grid"), width: 1 },
    font: "12px system-ui, sans-serif",
    labelFont: "12px system-ui, sans-serif",
    labelSize: 18,
  };
  return [{ ...common, size: 30, ...bottom }, { ...common, size: 52, label: unit }];
}

class Chart {
  constructor(plot, history, view) {
    Object.assign(this, plot, { history, view });
    this.columns = this.curves.map(([column]) => history.indexOf.get(column));
    this.hidden = this.curves.map(() => false);
    this.shown = this.curves.map(() => false);
    this.frame = element("div", { class: "frame" });
    this.legend = element("ul", { class: "legend", "aria-label": `Curves of ${this.title}, ${this.unit}` });
    this.figure = element("figure", { "aria-label": this.title }, element("figcaption", {}, `${this.title} (${this.unit})`), this.frame, this.legend);
    this.keys = this.curves.map(([, words], i) => this.key(words, i));
    if (CAN_PLOT) this.frame.setAttribute("aria-hidden", "true");
    else this.frame.append(element("p", { class: "no-plots" }, "No plot: this program was built without uPlot."));
    this.visible = true;
  }
  key(words, i) {
    const value = element("span", { class: "value" }, "–");
    const button = element("button", { type: "button", "aria-pressed": "true", title: "Show or hide" }, `${words} `, value);
    button.style.setProperty("--colour", `var(--c${i})`);
    button.dataset.line = this.curves[i][2] ?? "plain";
    button.onclick = () => {
      this.hidden[i] = !this.hidden[i];
      button.setAttribute("aria-pressed", String(!this.hidden[i]));
      this.plot?.setSeries(i + 1, { show: !this.hidden[i] });
    };
    const item = element("li", { hidden: "" }, button);
    this.legend.append(item);
    return { item, value };
  }
  /** Makes the plot, once the figure has its place and width. */
  open() {
    if (!CAN_PLOT) return;
    const series = this.curves.map(([, label, line], i) => ({
      label, stroke: () => styleOf(`--c${i}`), width: line === "wide" ? 4 : 1, alpha: line === "wide" ? 0.4 : 1, points: { show: false }, show: false,
    }));
    this.plot = new uPlot({
      width: this.frame.clientWidth, height: HEIGHT, legend: { show: false }, pxAlign: false,
      scales: { x: { time: false, range: (_plot, min, max) => [min, max] } },
      axes: axes(this.unit, { values: (_plot, splits) => splits.map((value) => `${Number(value.toFixed(3))} s`) }),
      series: [{}, ...series],
      cursor: { sync: { key: "patella", setSeries: false }, drag: { x: true, y: false, setScale: false }, points: { size: 7 },
        bind: { dblclick: () => () => this.view.release() } },
      hooks: {
        setSelect: [(plot) => {
          if (plot.select.width < 4) return;
          this.view.hold(plot.posToVal(plot.select.left, "x"), plot.posToVal(plot.select.left + plot.select.width, "x"));
          plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
        }],
        drawClear: [(plot) => this.drawMarks(plot)],
      },
    }, [[0], ...this.curves.map(() => [null])], this.frame);
  }
  /** Marks: red where a fault came, grey where the state changed. */
  drawMarks(plot) {
    const { ctx } = plot;
    const { left, top, width, height } = plot.bbox;
    ctx.save();
    for (const { time, raised } of this.view.marks()) {
      const x = plot.valToPos(time, "x", true);
      if (x < left || x > left + width) continue;
      ctx.strokeStyle = styleOf(raised ? "--mark" : "--weak");
      ctx.setLineDash(raised ? [] : [2, 4]);
      ctx.lineWidth = raised ? 2 : 1;
      ctx.beginPath();
      ctx.moveTo(x, top);
      ctx.lineTo(x, top + height);
      ctx.stroke();
    }
    ctx.restore();
  }
  draw(from, to, shared) {
    this.columns.forEach((column, i) => {
      if (this.shown[i] || !this.history.seen[column]) return;
      this.shown[i] = true;
      this.keys[i].item.hidden = false;
      this.plot?.setSeries(i + 1, { show: !this.hidden[i] });
    });
    if (!this.plot) return;
    const curves = this.columns.map((column, i) =>
      this.shown[i] && !this.hidden[i] ? this.history.curve(column, shared, this.factor) : new Array(shared.times.length).fill(null));
    // Dashes of a curve that stands for many ticks a pixel cost much and show nothing.
    this.curves.forEach(([, , line], i) => (this.plot.series[i + 1].dash = shared.size <= LARGEST_DASHED ? DASHES[line] ?? null : null));
    this.plot.batch(() => {
      this.plot.setData([shared.times, ...curves], false);
      this.plot.setScale("x", { min: from, max: to });
    });
  }
  /** Values of a tick, as text. */
  tell(valueOf) {
    this.columns.forEach((column, i) => {
      const value = this.factor * valueOf(column);
      const text = Number.isFinite(value) ? value.toFixed(2) : "–";
      if (this.keys[i].value.textContent !== text) this.keys[i].value.textContent = text;
    });
  }
  resize() {
    const width = this.frame.clientWidth;
    if (this.plot && width > 0 && width !== this.plot.width) this.plot.setSize({ width, height: HEIGHT });
  }
}
