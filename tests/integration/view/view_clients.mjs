// A live run in virtual time, watched by clients of @foxglove/ws-protocol: what they decode is what ticks.csv has. Who may
// not connect is refused; who sends garbage or reads nothing leaves the others and the run alone.
//
//   node view_clients.mjs NPM_FOLDER PATELLA CONFIGURATION FOLDER
import { createRequire } from "node:module";
import { spawn } from "node:child_process";
import { isDeepStrictEqual } from "node:util";
import fs from "node:fs";
import http from "node:http";
import path from "node:path";

const [npm, patella, configuration, folder] = process.argv.slice(2);
const require = createRequire(path.join(path.resolve(npm), "package.json"));
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const WebSocket = require("ws");

let failures = 0;
const check = (holds, words) => {
  console.log((holds ? "ok    " : "FAILS ") + words);
  failures += holds ? 0 : 1;
};
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const ended = (child) => new Promise((done) => (child.exitCode !== null ? done(child.exitCode) : child.on("exit", done)));

function start(args) {
  const child = spawn(patella, args);
  child.text = "";
  for (const stream of [child.stdout, child.stderr]) stream.on("data", (data) => (child.text += data));
  return child;
}

async function serve(run, more = []) {
  for (let attempt = 0; attempt < 200; ++attempt) {
    const server = start(["view", run, ...(more.includes("--listen") ? [] : ["--listen", "127.0.0.1:0"]), ...more]);
    while (server.exitCode === null && !server.text.includes("serving")) await wait(10);
    const port = /:(\d+)\n/.exec(server.text)?.[1];
    if (port) return { server, port };
    await wait(50); // the run has not begun yet
  }
  throw new Error("the server does not start");
}

// The status of an answer, or "open".
const attempt = (url, protocols, headers = {}) =>
  new Promise((done) => {
    const socket = new WebSocket(url, protocols, { headers });
    socket.on("open", () => done({ status: "open", socket }));
    socket.on("unexpected-response", (_request, response) => done({ status: response.statusCode }));
    socket.on("error", () => done({ status: "error" }));
  });

const kinds = ["foxglove.websocket.v1", "foxglove.sdk.v1"];
class Viewer {
  messages = new Map();
  closed = false;
  constructor(port, kind) {
    const socket = new WebSocket(`ws://127.0.0.1:${port}`, [kind]);
    this.client = new FoxgloveClient({ ws: socket });
    this.opened = new Promise((done) => socket.on("open", () => done(socket.protocol)));
    this.client.on("serverInfo", (info) => (this.info = info));
    const byId = new Map();
    this.client.on("advertise", (channels) => {
      this.channels = channels;
      for (const channel of channels) {
        const reader = new MessageReader(parse(channel.schema, { ros2: true }));
        byId.set(this.client.subscribe(channel.id), { topic: channel.topic, reader });
        this.messages.set(channel.topic, []);
      }
    });
    this.client.on("message", ({ subscriptionId, timestamp, data }) => {
      const { topic, reader } = byId.get(subscriptionId);
      this.messages.get(topic).push({ timestamp, value: reader.readMessage(data) });
    });
    this.client.on("close", () => (this.closed = true));
  }
}

const run = path.join(folder, "run");
const loop = start(["run", "--config", configuration, "--clock", "monotonic", "--duration", "12", "--out", run]);
const { server, port } = await serve(run);
const url = `ws://127.0.0.1:${port}`;

check((await attempt(url, [])).status === 400, "an upgrade without a subprotocol gets 400");
check((await attempt(url, ["other"])).status === 400, "so does one with another");
check((await attempt(url, kinds, { Origin: "https://elsewhere.example" })).status === 403, "a page of another site is refused");
check((await attempt(url, kinds, { Host: `elsewhere.example:${port}` })).status === 403, "so is a name that was made to lead here");
const page = await new Promise((done) => http.get(`http://127.0.0.1:${port}/`, (response) => done(response)));
const policy = page.headers["content-security-policy"];
check(page.statusCode === 200 && /^default-src 'none'; script-src 'nonce-\w{32}'; style-src 'nonce-\w{32}'; connect-src 'self';/.test(policy) && !policy.includes("unsafe"), "a browser gets a page that may load nothing but its own");
const post = await new Promise((done) => http.request(`http://127.0.0.1:${port}/`, { method: "POST" }, done).end());
check(post.statusCode === 405, "nothing but to look is served");

const lazy = (await attempt(url, kinds)).socket; // subscribes to all and reads nothing
lazy._socket.pause();
lazy.send(JSON.stringify({ op: "subscribe", subscriptions: [0, 1, 2, 3, 4, 5].map((id) => ({ id, channelId: id })) }));
const rude = (await attempt(url, kinds)).socket;
const complaints = [];
rude.on("message", (data) => complaints.push(JSON.parse(data)));
for (const garbage of ["", "{", "[]", '{"op":1}', '{"op":"subscribe"}', '{"op":"subscribe","subscriptions":[{"id":-1,"channelId":"x"}]}', '{"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]}', "[".repeat(9000), '{"op":"advertise","channels":[]}']) rude.send(garbage);
rude.send(Buffer.from([1, 2, 3]));
for (let i = 0; i < 250 && complaints.length < 12; ++i) await wait(20); // with what every client is told first
const statuses = complaints.filter(({ op }) => op === "status");
check(statuses.length === 10 && rude.readyState === WebSocket.OPEN, `garbage is answered in words: ${statuses[0]?.message}`);
check(statuses.some(({ message }) => message.includes("no capabilities")), "an operation that commands is not served");
const longest = new Promise((done) => rude.on("close", done));
rude.send("x".repeat(20000));
check((await longest) === 1009, "a message that is too long ends its connection");
const more = [];
for (let i = 0; i < 7; ++i) more.push((await attempt(url, kinds)).socket);
check((await attempt(url, kinds)).status === 503, "a ninth client is refused");
const gone = Promise.all(more.map((socket) => new Promise((done) => socket.on("close", done))));
more.forEach((socket) => socket.close());
await gone;

const viewers = kinds.map((kind) => new Viewer(port, kind));
check(isDeepStrictEqual(await Promise.all(viewers.map(({ opened }) => opened)), kinds), "both subprotocols are served");

await ended(loop);
await ended(server);
await wait(200);
check(server.exitCode === 0, `the server ends with the run: ${server.text.trim()}`);
const lines = (name) => fs.readFileSync(path.join(run, name), "utf8").split("\n").filter((line) => line !== "");
const [header, ...rows] = lines("ticks.csv").map((line) => line.split(","));
const byTime = new Map(rows.map((row) => [Number(row[0]), row]));
const numbersOf = (tick) => Object.values(tick).flatMap((value) => (typeof value === "number" ? [value] : [...value]));
const same = (cell, value) => (cell === "" ? Number.isNaN(value) : Number(cell) === value);
const events = new Set(lines("events.log"));
for (const [i, viewer] of viewers.entries()) {
  check(isDeepStrictEqual(viewer.info?.capabilities, []) && viewer.channels?.length === 6, `${kinds[i]}: six channels, no capabilities`);
  const ticks = viewer.messages.get("/patella/tick");
  const unequal = ticks.filter(({ value }) => {
    const row = byTime.get(value.t_s);
    const numbers = numbersOf(value);
    return row === undefined || numbers.length !== header.length || !row.every((cell, k) => same(cell, numbers[k]));
  });
  check(ticks.length > 1000 && unequal.length === 0, `${kinds[i]}: ${ticks.length} ticks equal ticks.csv to the last bit`);
  check(ticks.every(({ value }, k) => k === 0 || value.t_s > ticks[k - 1].value.t_s), `${kinds[i]}: in their order`);
  const joints = viewer.messages.get("/joint_states");
  // The subscriptions begin one after the other, maybe in the midst of a tick.
  const knee = new Map(ticks.map(({ timestamp, value }) => [timestamp, value.q_rad[1]]));
  const paired = joints.filter(({ timestamp }) => knee.has(timestamp));
  check(paired.length > 1000 && paired.every(({ timestamp, value }) => value.position[1] === knee.get(timestamp)), `${kinds[i]}: ${paired.length} joint states are those of their ticks`);
  const frames = viewer.messages.get("/patella/can");
  const logged = new Set(lines("frames.log").map((line) => line.split(" ")[2]));
  const text = ({ id, dlc, data }) => id.toString(16).toUpperCase().padStart(3, "0") + "#" + Buffer.from(data.slice(0, dlc)).toString("hex").toUpperCase();
  check(frames.length > 5000 && frames.every(({ value }) => logged.has(text(value))), `${kinds[i]}: ${frames.length} frames are in frames.log`);
  check(viewer.messages.get("/patella/timing").length > 1, `${kinds[i]}: timing comes each second`);
  check(viewer.messages.get("/patella/events").every(({ value }) => events.has(value.msg)), `${kinds[i]}: events are lines of events.log`);
}
const summary = JSON.parse(fs.readFileSync(path.join(run, "summary.json"), "utf8"));
check(summary.recorder.ticks_dropped === 0 && summary.recorder.frames_dropped === 0, "the recorder dropped nothing");

// Virtual time with a token, and the same run unwatched.
const token = "correct-horse-battery";
fs.writeFileSync(path.join(folder, "token"), token + "\n");
const refused = start(["view", run, "--listen", "0.0.0.0:0"]);
check((await ended(refused)) === 1 && refused.text.includes("about a patient"), `another address needs a token: ${refused.text.trim()}`);
const runIn = async (name, watch) => {
  const out = path.join(folder, name);
  const child = start(["run", "--config", configuration, "--clock", "virtual", "--duration", "120", "--out", out]);
  if (watch) {
    const watched = await serve(out, ["--listen", "0.0.0.0:0", "--token-file", path.join(folder, "token")]);
    const address = `ws://127.0.0.1:${watched.port}`;
    const right = await attempt(`${address}/?token=${token}`, kinds);
    const six = await Promise.all(Array.from({ length: 6 }, () => attempt(`${address}/?token=${token}`, kinds)));
    const rude = await attempt(`${address}/?token=${token}`, kinds);
    check((await attempt(`${address}/?token=wrong`, kinds)).status === 403, "a wrong token is refused");
    check((await attempt(address, kinds)).status === 403, "so is none");
    check(right.status === "open", "the right one is not");
    const all = JSON.stringify({ op: "subscribe", subscriptions: [0, 1, 2, 3, 4, 5].map((id) => ({ id, channelId: id })) });
    let received = 0;
    for (const { socket } of six) socket.on("message", () => ++received);
    for (const { socket } of [right, ...six]) socket.send(all);
    right.socket._socket.pause();
    for (let i = 0; i < 100 && received < 30000; ++i) {
      rude.socket.send("garbage");
      await wait(20);
    }
    check(received > 1000 && child.exitCode === null, `eight clients are served, one that reads nothing and one that sends garbage: ${received} messages`);
    watched.server.kill("SIGKILL");
  }
  await ended(child);
  return out;
};
const [a, b] = [await runIn("watched", true), await runIn("alone", false)];
for (const name of ["ticks.csv", "frames.log", "events.log", "summary.json"])
  check(fs.readFileSync(path.join(a, name)).equals(fs.readFileSync(path.join(b, name))), `${name} has the same bytes with eight clients, whose server is then killed, and with none`);
process.exit(failures === 0 ? 0 : 1);
