// CANopen slaves by another author (npm canopen): object dictionary, SDO server, PDOs, network management, heartbeat and
// SYNC are that package's. What it has not are the states of CiA 402, which are here, after the standard's table.
// Frames come and go as lines in the notation of candump, `201#0F000000`, on standard input and output.
//
//   node slave.cjs NPM_FOLDER EDS NODE:COUNTS...
//
// When the input ends, standard error has a line for each node: its last states, and what it was told.
"use strict";
const Module = require("module");
const path = require("path");

const [npm, sheet, ...places] = process.argv.slice(2);
// A compiled part of the package computes the CRC of block transfers, which nobody asks for here.
const load = Module._load;
Module._load = (name, ...rest) =>
  name === "node-crc" ? { crc() { throw new Error("no block transfer was expected"); } } : load(name, ...rest);
const { Device, Eds } = require(path.join(npm, "node_modules", "canopen"));

const State = { disabled: 0x0040, ready: 0x0021, on: 0x0023, enabled: 0x0027, fault: 0x0008 };

/** The next state by the controlword; `before` is the controlword before, of which a fault's reset needs an edge. */
function next(state, word, before) {
  if (state === State.fault) return word & 0x80 && !(before & 0x80) ? State.disabled : State.fault;
  if (!(word & 0x02)) return State.disabled; // disable voltage
  if (!(word & 0x04)) return State.disabled; // quick stop, of a drive that does not stay in it
  const command = word & 0x0f;
  if (command === 0x06) return State.ready;
  if (state === State.ready && (command === 0x07 || command === 0x0f)) return State.on;
  if ((state === State.on || state === State.enabled) && command === 0x0f) return State.enabled;
  if (state === State.enabled && command === 0x07) return State.on;
  return state;
}

class Slave {
  constructor(node, counts) {
    this.node = node;
    this.state = State.disabled;
    this.word = 0;
    this.enabledOnce = false;
    this.largest = 0;
    this.commands = 0;
    this.timeouts = 0;
    const eds = Eds.fromFile(sheet);
    eds.addSdoServerParameter(0, 0x580 + node, 0x600 + node);
    this.eds = eds;
    this.entry(0x6064).value = counts;
    this.device = new Device({ id: node, eds });
    this.device.addListener("message", ({ id, data }) => {
      process.stdout.write(`${id.toString(16).padStart(3, "0").toUpperCase()}#${data.toString("hex").toUpperCase()}\n`);
    });
    // Modes of operation: taken at once.
    eds.getEntry(0x6060).addListener("update", () => { this.entry(0x6061).value = this.entry(0x6060).value; });
    this.device.pdo.addListener("pdo", () => this.obey());
    this.device.nmt.addListener("timeout", () => {
      this.timeouts += 1;
      if (this.state === State.enabled) this.state = State.fault;
      this.tell();
    });
    this.device.start();
    this.tell();
  }
  entry(index) { return this.eds.getEntry(index); }
  obey() {
    this.commands += 1;
    const word = this.entry(0x6040).value;
    this.state = next(this.state, word, this.word);
    this.word = word;
    this.enabledOnce = this.enabledOnce || this.state === State.enabled;
    this.tell();
  }
  tell() {
    const torque = this.state === State.enabled ? this.entry(0x6071).value : 0;
    this.largest = Math.max(this.largest, Math.abs(torque));
    this.entry(0x6041).value = 0x0210 | this.state; // voltage enabled, remote
    this.entry(0x6077).value = torque;
  }
  summary() {
    const state = Object.keys(State).find((name) => State[name] === this.state);
    return `node=${this.node} state=${state} enabled_once=${this.enabledOnce} largest_per_mille=${this.largest} ` +
      `changes=${this.commands} heartbeat_timeouts=${this.timeouts} nmt=${this.device.state} ` +
      `mode=${this.entry(0x6061).value} mapped=${this.eds.getTransmitPdos().map((pdo) => pdo.dataObjects.length)}`;
  }
}

const slaves = places.map((place) => new Slave(...place.split(":").map(Number)));
let rest = "";
process.stdin.on("data", (chunk) => {
  const lines = (rest + chunk).split("\n");
  rest = lines.pop();
  for (const line of lines) {
    const [id, data] = line.split("#");
    const frame = { id: parseInt(id, 16), data: Buffer.from(data, "hex"), len: data.length / 2 };
    for (const slave of slaves) slave.device.receive(frame);
  }
});
process.stdin.on("end", () => {
  for (const slave of slaves) process.stderr.write(`${slave.summary()}\n`);
  process.exit(0);
});
