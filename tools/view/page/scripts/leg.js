// The leg from the side: angle of the first joint from the horizontal, the second relative to it; hanging is (-90°, 0).
class Leg {
  /** What has more joints is no leg, and the run does not tell which of them carries which. */
  static shows(history) {
    return !history.indexOf.has("q3_rad");
  }
  constructor(svg, history) {
    this.history = history;
    this.svg = svg;
    svg.replaceChildren();
    this.ghost = [this.line("ghost"), this.line("ghost")];
    this.line("ground", { x1: -100, y1: -62, x2: 100, y2: -62 });
    this.limbs = [this.line("limb"), this.line("limb")];
    this.joints = [this.node("circle", { r: 7, cx: 0, cy: -62 }), this.node("circle", { r: 6 })];
    this.columns = ["q", "ref"].map((stem) => [1, 2].map((joint) => history.indexOf.get(`${stem}${joint}_rad`)));
  }
  node(name, attributes) {
    const node = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    this.svg.append(node);
    return node;
  }
  line(kind, at = {}) {
    return this.node("line", { class: kind, ...at });
  }
  angles(row) {
    return this.columns.map((columns) => columns.map((column) => (column === undefined ? NaN : row[column])));
  }
  draw(row) {
    const [measured, reference] = this.angles(row);
    this.place(this.limbs, measured, true);
    this.place(this.ghost, reference, false);
  }
  /** The same in words. */
  tell(row) {
    const [first, second] = this.angles(row)[0].map((angle) => (Number.isNaN(angle) ? "unknown" : `${Math.round(DEGREES * angle)} degrees`));
    const words = `The leg from the side, as far as it is measured; dashed: the reference. First joint ${first}, second joint ${second}.`;
    if (this.svg.getAttribute("aria-label") !== words) this.svg.setAttribute("aria-label", words);
  }
  place(lines, angles, withJoint) {
    let [x, y, direction] = [0, -62, 0];
    lines.forEach((line, i) => {
      const known = !Number.isNaN(angles[i]);
      line.style.display = known ? "" : "none";
      if (withJoint && i === 1) this.joints[1].style.display = known ? "" : "none";
      if (!known) return;
      if (withJoint) this.joints[i].setAttribute("cx", x), this.joints[i].setAttribute("cy", y);
      direction += angles[i];
      const end = [x + 78 * Math.cos(direction), y - 78 * Math.sin(direction)];
      const at = { x1: x, y1: y, x2: end[0], y2: end[1] };
      for (const [key, value] of Object.entries(at)) line.setAttribute(key, value.toFixed(1));
      [x, y] = end;
    });
  }
}
