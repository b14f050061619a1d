// Draws the figures whose curves stand beside them as JSON anew, so that they can be looked into: values at the
// cursor, zoom along x by dragging, the whole by a double click. Without scripts the still pictures remain.
"use strict";
(() => {
  const NAMESPACE = document.documentElement.querySelector("figure svg")?.namespaceURI;
  const HEIGHT = 300;
  const MARGIN = { left: 70, right: 16, top: 8, bottom: 42 };
  const SHORTEST_DRAG = 4; // pixels: anything less is a click

  function svg(name, attributes, text) {
    const node = document.createElementNS(NAMESPACE, name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    if (text !== undefined) node.textContent = text;
    return node;
  }

  function html(name, className, text) {
    const node = document.createElement(name);
    node.className = className;
    if (text !== undefined) node.textContent = text;
    return node;
  }

  const shortText = (value) => (value === null ? "–" : String(Number(value.toPrecision(5))));

  /** Index of the first element that is not below the value. */
  function lowerBound(sorted, value) {
    let [low, high] = [0, sorted.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (sorted[middle] < value) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** Round numbers, about `count` of them, in the range; of a logarithmic one its powers of ten. */
  function ticks([low, high], count, logarithmic) {
    const found = [];
    if (logarithmic) {
      const steps = high / low > 10 ? [1] : [1, 2, 5];
      for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); ++power)
        for (const step of steps) found.push(step * 10 ** power);
    } else {
      const rough = (high - low) / count;
      const power = 10 ** Math.floor(Math.log10(rough));
      const step = power * [1, 2, 5, 10].find((digit) => digit * power >= rough);
      for (let i = Math.ceil(low / step); i * step <= high; ++i) found.push(i * step);
    }
    return found.filter((value) => value >= low && value <= high);
  }

  class Scale {
    constructor(range, from, to, logarithmic) {
      this.bend = logarithmic ? Math.log10 : (value) => value;
      this.unbend = logarithmic ? (value) => 10 ** value : (value) => value;
      this.range = range;
      this.from = from;
      this.low = this.bend(range[0]);
      this.slope = (to - from) / (this.bend(range[1]) - this.low);
    }
    pixel(value) {
      return this.from + (this.bend(value) - this.low) * this.slope;
    }
    value(pixel) {
      return this.unbend(this.low + (pixel - this.from) / this.slope);
    }
  }

  class Chart {
    constructor(figure, data) {
      this.figure = figure;
      this.data = data;
      this.whole = data.x_range ?? extent(data.series.flatMap((series) => series.x));
      this.range = this.whole;
      this.values = html("div", "values");
      this.canvas = svg("svg", { class: "chart", height: HEIGHT });
      const legend = html("figcaption", "", data.title);
      for (const series of data.series) {
        const entry = html("span", "key", series.label);
        entry.style.setProperty("--colour", series.colour);
        legend.append(entry);
      }
      legend.append(html("span", "hint", "drag to zoom, double click for the whole"));
      figure.classList.add("live");
      figure.append(legend, this.canvas, this.values);
      this.canvas.addEventListener("pointerdown", (event) => this.press(event));
      this.canvas.addEventListener("pointermove", (event) => this.move(event));
      this.canvas.addEventListener("pointerup", (event) => this.release(event));
      this.canvas.addEventListener("pointerleave", () => this.leave());
      this.canvas.addEventListener("pointercancel", () => this.leave());
      this.canvas.addEventListener("dblclick", () => this.zoom(this.whole));
      new ResizeObserver(() => this.draw()).observe(figure);
    }

    zoom(range) {
      this.range = range;
      this.leave();
      this.draw();
    }

    draw() {
      this.width = this.canvas.clientWidth;
      if (this.width <= MARGIN.left + MARGIN.right) return;
      this.canvas.setAttribute("viewBox", `0 0 ${this.width} ${HEIGHT}`);
      this.x = new Scale(this.range, MARGIN.left, this.width - MARGIN.right, this.data.log_x);
      this.y = new Scale(this.visibleHeight(), HEIGHT - MARGIN.bottom, MARGIN.top, this.data.log_y);
      const [x, y] = [MARGIN.left, MARGIN.top];
      const [width, height] = [this.width - x - MARGIN.right, HEIGHT - y - MARGIN.bottom];
      const plot = svg("svg", { x, y, width, height, viewBox: `${x} ${y} ${width} ${height}` });
      for (const shade of this.data.shades) plot.append(this.band(shade.from, shade.to, { fill: shade.colour }));
      const axes = this.axes(plot);
      for (const series of this.data.series) plot.append(this.curve(series));
      this.marks = svg("g", {});
      plot.append(this.marks);
      this.canvas.replaceChildren(plot, axes);
    }

    /** Range of what is to be seen of the curves, with some air. */
    visibleHeight() {
      const logarithmic = this.data.log_y;
      const seen = this.data.series.flatMap((series) => {
        const first = Math.max(0, lowerBound(series.x, this.range[0]) - 1);
        return series.y.slice(first, lowerBound(series.x, this.range[1]) + 1);
      });
      let [low, high] = extent(seen.filter((value) => value !== null && (value > 0 || !logarithmic)));
      if (logarithmic) return [low / 1.2, high * 1.2];
      // A limit far away is worth less than the shape of the curve.
      const reach = 2 * (high - low);
      const near = this.data.levels.map((level) => level.value).filter((value) => value > low - reach && value < high + reach);
      [low, high] = extent([low, high, ...near]);
      const air = Math.max(0.06 * (high - low), 1e-9 + 1e-3 * Math.max(Math.abs(low), Math.abs(high)));
      return [low - air, high + air];
    }

    band(from, to, attributes) {
      const x = this.x.pixel(from);
      return svg("rect", { x, width: this.x.pixel(to) - x, y: MARGIN.top, height: HEIGHT, ...attributes });
    }

    axes(plot) {
      const axes = svg("g", { class: "axes" });
      const [right, bottom] = [this.width - MARGIN.right, HEIGHT - MARGIN.bottom];
      const count = Math.max(2, this.width / 110);
      for (const value of ticks(this.range, count, this.data.log_x)) {
        const at = this.x.pixel(value);
        plot.append(svg("path", { class: "grid", d: `M${at} ${MARGIN.top}V${bottom}` }));
        axes.append(svg("text", { class: "x tick", x: at, y: bottom + 17 }, shortText(value)));
      }
      for (const value of ticks(this.y.range, 5, this.data.log_y)) {
        const at = this.y.pixel(value);
        plot.append(svg("path", { class: "grid", d: `M${MARGIN.left} ${at}H${this.width}` }));
        axes.append(svg("text", { class: "y tick", x: MARGIN.left - 6, y: at + 4 }, shortText(value)));
      }
      for (const level of this.data.levels) {
        if (level.value < this.y.range[0] || level.value > this.y.range[1]) continue;
        const at = this.y.pixel(level.value);
        plot.append(svg("path", { class: "level", d: `M${MARGIN.left} ${at}H${this.width}` }));
        plot.append(svg("text", { class: "level", x: right - 4, y: Math.max(at - 4, MARGIN.top + 12) }, level.label));
      }
      axes.append(svg("path", { class: "frame", d: `M${MARGIN.left} ${MARGIN.top}V${bottom}H${right}` }));
      axes.append(svg("text", { x: (MARGIN.left + right) / 2, y: HEIGHT - 6 }, this.data.x_label));
      const upright = `translate(14 ${(MARGIN.top + bottom) / 2}) rotate(-90)`;
      axes.append(svg("text", { transform: upright }, this.data.y_label));
      return axes;
    }

    curve(series) {
      let d = "";
      let pen = "M";
      series.x.forEach((x, i) => {
        const y = series.y[i];
        if (y === null || (this.data.log_y && y <= 0)) {
          pen = "M";
          return;
        }
        d += `${pen}${this.x.pixel(x).toFixed(1)} ${this.y.pixel(y).toFixed(1)}`;
        pen = "L";
      });
      const dashes = series.dashed ? "8 4" : "none";
      return svg("path", { d, stroke: series.colour, "stroke-width": series.width, "stroke-dasharray": dashes });
    }

    press(event) {
      event.preventDefault();
      this.canvas.setPointerCapture(event.pointerId);
      this.start = this.inside(event);
    }

    /** The cursor's place between the ends of the x axis. */
    inside(event) {
      const at = event.clientX - this.canvas.getBoundingClientRect().left;
      return Math.min(Math.max(at, MARGIN.left), this.width - MARGIN.right);
    }

    move(event) {
      const at = this.inside(event);
      const x = this.x.value(at);
      this.marks.replaceChildren(svg("path", { class: "cursor", d: `M${at} ${MARGIN.top}V${HEIGHT}` }));
      if (this.start !== undefined) {
        const ends = [this.start, at].map((pixel) => this.x.value(pixel)).sort((a, b) => a - b);
        this.marks.append(this.band(ends[0], ends[1], { class: "selection" }));
      }
      const [name, unit] = this.data.x_label.split(" / ");
      this.values.replaceChildren(html("b", "", `${name.split(",")[0]} ${shortText(x)} ${unit ?? ""}`));
      for (const series of this.data.series) this.show(series, x);
      const left = at < this.width / 2;
      this.values.style.left = left ? `${at + 14}px` : "";
      this.values.style.right = left ? "" : `${this.width - at + 14}px`;
      const top = this.canvas.getBoundingClientRect().top - this.figure.getBoundingClientRect().top;
      this.values.style.top = `${top + MARGIN.top + 6}px`;
      this.values.classList.add("shown");
    }

    /** The curve's value nearest to x, in words and as a dot. */
    show(series, x) {
      const above = lowerBound(series.x, x);
      const nearest = x - (series.x[above - 1] ?? -Infinity) < (series.x[above] ?? Infinity) - x ? above - 1 : above;
      const y = series.y[nearest] ?? null;
      const row = html("div", "key", `${series.label} ${shortText(y)} ${this.data.y_label.split(" / ").pop()}`);
      row.style.setProperty("--colour", series.colour);
      this.values.append(row);
      if (y === null) return;
      const place = { cx: this.x.pixel(series.x[nearest]), cy: this.y.pixel(y) };
      this.marks.append(svg("circle", { r: 3.5, fill: series.colour, ...place }));
    }

    release(event) {
      const pressed = this.start;
      this.start = undefined;
      const at = this.inside(event);
      if (pressed !== undefined && Math.abs(at - pressed) >= SHORTEST_DRAG)
        this.zoom([pressed, at].map((pixel) => this.x.value(pixel)).sort((a, b) => a - b));
    }

    leave() {
      this.start = undefined;
      this.values.classList.remove("shown");
      this.marks?.replaceChildren();
    }
  }

  function extent(values) {
    let [low, high] = [Infinity, -Infinity];
    for (const value of values) {
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
    return low < high ? [low, high] : low === high ? [low - 1, high + 1] : [0.1, 1];
  }

  for (const data of document.querySelectorAll("script.curves"))
    new Chart(data.parentElement, JSON.parse(data.textContent));
})();
