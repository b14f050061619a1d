// A finished run: its messages by the second, over HTTP. The window ends at the player's time.
const KEPT_S = 60; // before the player's time

class RecordingSource {
  constructor(run) {
    this.run = run;
    this.playing = false;
    this.loaded = null; // seconds [from, to) that are in the history
    this.load = Promise.resolve();
    this.open();
  }
  async get(path) {
    const response = await fetch(path + query(), { cache: "no-store" });
    if (!response.ok) throw new Error(await response.text());
    return response;
  }
  async open() {
    try {
      const answer = await (await this.get("/recording")).json();
      Object.assign(this, answer.recording);
      this.run.begin(answer.server_info);
      this.run.advertised(answer.advertise.channels);
      this.run.recordedEvents(this.events);
      this.run.connection("recording", "recorded run, not live");
      this.at = this.start_s;
      this.run.opened(this);
      this.seek(Math.min(this.start_s + 10, this.end_s));
    } catch (error) {
      this.run.connection("lost", error.message);
    }
  }
  /** Goes to a time. Seconds are loaded one after the other; a newer wish ends the loading for an older one. */
  seek(time) {
    this.at = Math.min(Math.max(time, this.start_s), this.end_s);
    this.load = this.load.then(() => this.fill());
    this.run.moved();
  }
  async fill() {
    const second = (time) => Math.min(Math.floor(time) - Math.floor(this.start_s), this.seconds - 1);
    const to = second(this.at);
    const kept = Math.min(KEPT_S, this.run.span());
    const from = Math.max(second(this.at - kept), 0);
    const joins = this.loaded !== null && from >= this.loaded.from && to >= this.loaded.to - 1 && from <= this.loaded.to;
    const within = this.loaded !== null && from >= this.loaded.from && to < this.loaded.to;
    if (within) return;
    if (!joins) {
      this.run.forget();
      this.loaded = { from, to: from };
    }
    const wished = this.at;
    try {
      while (this.loaded.to <= to) {
        const bytes = await (await this.get(`/recording/${this.loaded.to}`)).arrayBuffer();
        this.take(bytes);
        ++this.loaded.to;
        this.loaded.from = Math.max(this.loaded.from, this.loaded.to - kept - 2);
        this.run.moved();
        if (Math.abs(this.at - wished) > 1) return;
      }
    } catch (error) {
      this.run.connection("lost", error.message);
      this.play(false);
    }
  }
  take(bytes) {
    const view = new DataView(bytes);
    for (let at = 0; at + 4 <= bytes.byteLength; ) {
      const length = view.getUint32(at, true);
      this.run.message(view.getUint32(at + 5, true), Number(view.getBigUint64(at + 9, true)), view, at + 17);
      at += 4 + length;
    }
  }
  play(on) {
    this.playing = on && this.at < this.end_s;
    this.last = performance.now();
    this.run.played(this.playing);
  }
  /** As time goes on; called for each picture. */
  advance(now) {
    if (!this.playing) return;
    const step = Math.min(1e-3 * (now - this.last), 0.5);
    this.last = now;
    this.seek(this.at + step);
    if (this.at >= this.end_s) this.play(false);
  }
}
