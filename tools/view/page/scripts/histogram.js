// How long the ticks of the shown window took to wake up and to execute: buckets of half an octave.
const BUCKETS = 40;

class Histogram {
  constructor(title, stem) {
    this.title = title;
    this.unit = "ticks";
    this.stem = stem;
    this.frame = element("div", { class: "frame" });
    this.text = element("p", { class: "no-plots" }, "–");
    this.figure = element("figure", { "aria-label": title }, element("figcaption", {}, `${title} (ticks a bucket, µs)`), this.frame, this.text);
    if (CAN_PLOT) this.frame.setAttribute("aria-hidden", "true");
    this.visible = true;
  }
  open() {
    if (!CAN_PLOT) return;
    this.plot = new uPlot({
      width: this.frame.clientWidth, height: HEIGHT, legend: { show: false }, cursor: { show: false },
      scales: { x: { time: false, range: () => [-0.7, this.last + 0.7] }, y: { distr: 3, range: () => [0.5, 2 * this.largest] } },
      axes: axes(this.unit, { splits: () => this.places(), values: (_plot, splits) => splits.map((i) => String(Math.round(2 ** (i / 2)))) }),
      series: [{}, { stroke: () => styleOf("--c0"), fill: () => styleOf("--c5"), paths: uPlot.paths.bars({ size: [0.9, 60] }), points: { show: false } }],
    }, [[0], [null]], this.frame);
  }
  last = 20;
  largest = 1;
  places() {
    const step = this.last > 16 ? 4 : 2;
    return Array.from({ length: Math.floor(this.last / step) + 1 }, (_value, i) => i * step);
  }
  /** Adds the seconds of the window up. */
  draw(seconds) {
    const counts = new Array(BUCKETS).fill(0);
    let [p999, most] = [NaN, NaN];
    for (const second of seconds) {
      second[`${this.stem}_bucket_us`].forEach((end_us, i) => (counts[Math.min(Math.round(2 * Math.log2(end_us)), BUCKETS - 1)] += second[`${this.stem}_count`][i]));
      p999 = second[`${this.stem}_p99_9_us`];
      most = Math.max(second[`${this.stem}_max_us`], Number.isNaN(most) ? 0 : most);
    }
    const words = Number.isFinite(most) ? `99.9 % within ${p999.toFixed(1)} µs in the last second; longest in the ${seconds.length} s shown: ${most.toFixed(1)} µs` : "not known yet";
    if (this.text.textContent !== words) this.text.textContent = words;
    if (!this.plot) return;
    this.last = Math.max(counts.findLastIndex((count) => count > 0), 12);
    this.largest = Math.max(...counts, 1);
    this.plot.setData([counts.map((_count, i) => i), counts.map((count) => count || null)]);
  }
  resize() {
    const width = this.frame.clientWidth;
    if (this.plot && width > 0 && width !== this.plot.width) this.plot.setSize({ width, height: HEIGHT });
  }
}
