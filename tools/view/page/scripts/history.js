// The newest ticks, column by column, in memory that does not grow. Blocks of ticks keep their smallest and largest values, so
// that a minute is drawn without looking at each.
const CAPACITY = 1 << 16;
const BLOCK = 32;
const BLOCKS = CAPACITY / BLOCK;
const GAP = 10; // periods without a tick that the curves show as a gap

class History {
  constructor(columns) {
    this.columns = columns;
    this.indexOf = new Map(columns.map((name, i) => [name, i]));
    this.values = columns.map(() => new Float64Array(CAPACITY));
    this.least = columns.map(() => new Float64Array(BLOCKS));
    this.most = columns.map(() => new Float64Array(BLOCKS));
    this.time = this.indexOf.get("t_s");
    this.clear();
  }
  clear() {
    this.end = 0; // ticks that have come; the newest CAPACITY of them are there
    this.seen = this.columns.map(() => false);
    this.period = Infinity;
  }
  get begin() {
    return Math.max(0, this.end - CAPACITY);
  }
  value(column, n) {
    return this.values[column][n & (CAPACITY - 1)];
  }
  timeAt(n) {
    return this.value(this.time, n);
  }
  get newest() {
    return this.end > 0 ? this.timeAt(this.end - 1) : NaN;
  }
  /** A row of a tick. One that is no later than the newest begins anew: another run, or another place in it. */
  append(row) {
    const step = row[this.time] - this.newest;
    if (step <= 0) this.clear();
    else if (step < this.period) this.period = step;
    else if (step > GAP * this.period) this.put(row.map((_value, i) => (i === this.time ? row[this.time] - 0.5 * step : NaN)));
    this.put(row);
  }
  put(row) {
    const slot = this.end & (CAPACITY - 1);
    const block = slot >> 5;
    const fresh = slot % BLOCK === 0 || this.end === 0;
    for (let i = 0; i < row.length; ++i) {
      const value = row[i];
      const known = !Number.isNaN(value);
      this.values[i][slot] = value;
      if (fresh) {
        this.least[i][block] = known ? value : Infinity;
        this.most[i][block] = known ? value : -Infinity;
      } else if (known) {
        if (value < this.least[i][block]) this.least[i][block] = value;
        if (value > this.most[i][block]) this.most[i][block] = value;
      }
      if (known) this.seen[i] = true;
    }
    ++this.end;
  }
  /** The first tick that is not before a time. */
  find(time) {
    let [low, high] = [this.begin, this.end];
    while (low < high) {
      const middle = (low + high) >>> 1;
      if (this.timeAt(middle) < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }
  /** Where curves of a window stand: buckets of 2^k ticks from a multiple of them on, so that they do not flicker as time goes. */
  buckets(from, to, most) {
    const first = this.find(from);
    const last = Math.min(this.find(to) + 1, this.end);
    let size = 1;
    while ((last - first) / size > most) size *= 2;
    const start = Math.max(Math.floor(first / size) * size, Math.ceil(this.begin / size) * size);
    const count = Math.max(Math.ceil((last - start) / size), 0);
    const each = size === 1 ? 1 : 2;
    const times = new Array(count * each);
    for (let i = 0; i < count; ++i) {
      const n = start + i * size;
      times[i * each] = this.timeAt(n);
      if (each === 2) times[i * each + 1] = this.timeAt(Math.min(n + size / 2, this.end - 1));
    }
    return { start, size, count, last, times };
  }
  /** A column's smallest and largest value of each bucket, times a factor; a single tick has one value. null: not known. */
  curve(column, { start, size, count, last }, factor) {
    const curve = new Array(size === 1 ? count : 2 * count);
    const values = this.values[column];
    for (let i = 0; i < count; ++i) {
      const n = start + i * size;
      if (size === 1) {
        const value = values[n & (CAPACITY - 1)];
        curve[i] = Number.isNaN(value) ? null : factor * value;
        continue;
      }
      let [low, high] = [Infinity, -Infinity];
      const end = Math.min(n + size, last);
      if (size < BLOCK) {
        for (let k = n; k < end; ++k) {
          const value = values[k & (CAPACITY - 1)];
          if (value < low) low = value;
          if (value > high) high = value;
        }
      } else {
        for (let k = n; k < end; k += BLOCK) {
          const block = (k & (CAPACITY - 1)) >> 5;
          if (this.least[column][block] < low) low = this.least[column][block];
          if (this.most[column][block] > high) high = this.most[column][block];
        }
      }
      // In the order in which they came, as far as the ends of the bucket tell: a curve that falls has no steps upwards.
      const falls = values[n & (CAPACITY - 1)] > values[(end - 1) & (CAPACITY - 1)];
      curve[2 * i] = low <= high ? factor * (falls ? high : low) : null;
      curve[2 * i + 1] = low <= high ? factor * (falls ? low : high) : null;
    }
    return curve;
  }
}
