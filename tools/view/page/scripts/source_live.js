// A live run: the server's WebSocket, by the protocol that Foxglove speaks.
const RETRY_MS = 1000;

/** The query of this page, which holds the token where there is one. */
const query = () => location.search;

class LiveSource {
  constructor(run) {
    this.run = run;
    this.ended = false;
    this.connect();
  }
  connect() {
    const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/${query()}`, ["foxglove.websocket.v1"]);
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => (typeof data === "string" ? this.told(socket, JSON.parse(data)) : this.take(data));
    socket.onclose = () => {
      if (!this.ended) this.run.connection("lost", "connection lost, trying again");
      setTimeout(() => this.connect(), RETRY_MS);
    };
  }
  told(socket, message) {
    if (message.op === "serverInfo") {
      this.ended = false;
      this.run.begin(message);
    } else if (message.op === "advertise") {
      this.run.advertised(message.channels);
      // A subscription has the number of its channel. Single frames are not shown.
      const wanted = message.channels.filter(({ topic }) => WANTED.has(topic));
      socket.send(JSON.stringify({ op: "subscribe", subscriptions: wanted.map(({ id }) => ({ id, channelId: id })) }));
      this.run.connection("open", "live");
    } else if (message.op === "status") {
      this.ended = this.ended || message.message === "the run has ended";
      if (this.ended) this.run.connection("ended", "the run has ended");
      else this.run.note(message.message);
    }
  }
  take(data) {
    const view = new DataView(data);
    this.run.message(view.getUint32(1, true), Number(view.getBigUint64(5, true)), view, 13);
  }
}
const WANTED = new Set(["/patella/tick", "/patella/events", "/patella/timing"]);
