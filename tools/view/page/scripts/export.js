// The shown window as files: its ticks as CSV with the columns of ticks.csv, its plots as a picture.
function save(blob, name) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

function csvOf(history, from, to) {
  const lines = [history.columns.join(",")];
  const end = Math.min(history.find(to) + 1, history.end);
  for (let n = history.find(from); n < end; ++n) {
    const time = history.timeAt(n);
    // A gap is a tick of the curves, and none of the run.
    const known = history.columns.some((_name, i) => i !== history.time && !Number.isNaN(history.value(i, n)));
    if (time <= to && known) lines.push(history.columns.map((_name, i) => (Number.isNaN(history.value(i, n)) ? "" : history.value(i, n))).join(","));
  }
  return lines.join("\n") + "\n";
}

/** All plots below each other in two columns, as on the page, with titles and keys. */
function pictureOf(charts, heading) {
  const ratio = window.devicePixelRatio || 1;
  const drawn = charts.filter((chart) => chart.plot);
  const width = Math.max(...drawn.map((chart) => chart.plot.width)) + 20;
  const height = HEIGHT + 55;
  const columns = 2;
  const canvas = element("canvas");
  canvas.width = ratio * columns * width;
  canvas.height = ratio * (30 + height * Math.ceil(drawn.length / columns));
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  context.fillStyle = styleOf("--card");
  context.fillRect(0, 0, canvas.width, canvas.height);
  const write = (text, x, y, colour, font) => {
    context.fillStyle = colour;
    context.font = font;
    context.fillText(text, x, y);
    return context.measureText(text).width;
  };
  write(heading, 10, 20, styleOf("--text"), "bold 14px system-ui, sans-serif");
  drawn.forEach((chart, i) => {
    const [x, y] = [10 + width * (i % columns), 30 + height * Math.floor(i / columns)];
    write(`${chart.title} (${chart.unit})`, x, y + 16, styleOf("--text"), "bold 13px system-ui, sans-serif");
    context.drawImage(chart.plot.ctx.canvas, x, y + 22, chart.plot.width, chart.plot.height);
    let at = x + 10;
    chart.curves?.forEach(([, words], k) => {
      if (chart.shown[k] && !chart.hidden[k]) at += 14 + write(words, at, y + HEIGHT + 38, styleOf(`--c${k}`), "12px system-ui, sans-serif");
    });
  });
  return new Promise((done) => canvas.toBlob(done, "image/png"));
}
