// Reads MCAP files with @mcap/core, through the index and as a stream, decodes every message by its schema with
// @foxglove/rosmsg2-serialization, and holds every value against the files that the run left beside them.
//
//   node read_with_clients.mjs NPM_FOLDER RUN_FOLDER FILE.mcap=whole|part ... -- INPUT ...
import { createRequire } from "node:module";
import { createHash } from "node:crypto";
import { isDeepStrictEqual } from "node:util";
import fs from "node:fs";
import path from "node:path";

const [npm, run, ...rest] = process.argv.slice(2);
const require = createRequire(path.join(path.resolve(npm), "package.json"));
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { loadDecompressHandlers } = require("@mcap/support");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const files = rest.slice(0, rest.indexOf("--")).map((argument) => argument.split("="));
const inputs = rest.slice(rest.indexOf("--") + 1);

let failures = 0;
const check = (holds, words) => {
  console.log((holds ? "ok    " : "FAILS ") + words);
  failures += holds ? 0 : 1;
};

const lines = (name) => fs.readFileSync(path.join(run, name), "utf8").split("\n").filter((line) => line !== "");
const [header, ...rows] = lines("ticks.csv").map((line) => line.split(","));
const logged = lines("frames.log").map((line) => /^\((\d+)\.(\d{6})\) (\S+) ([0-9A-F]+)#([0-9A-F]*)/.exec(line));
const events = lines("events.log").filter((line) => line.startsWith("t_s="));
const summary = fs.readFileSync(path.join(run, "summary.json"), "utf8");

// The flat list of a Tick's numbers, in the order of its fields.
const numbersOf = (tick) => Object.values(tick).flatMap((value) => (typeof value === "number" ? [value] : [...value]));
const sameNumber = (cell, value) => (cell === "" ? Number.isNaN(value) : Object.is(Number(cell), value) || Number(cell) === value);

function decoderOf(schema) {
  return new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true }));
}

class Collector {
  schemas = new Map();
  channels = new Map();
  readers = new Map();
  messages = new Map(); // topic -> [{ logTime, publishTime, value }]
  attachments = [];
  metadata = [];

  add(record) {
    if (record.type === "Schema") this.schemas.set(record.id, record);
    else if (record.type === "Channel") this.channels.set(record.id, record);
    else if (record.type === "Attachment") this.attachments.push(record);
    else if (record.type === "Metadata") this.metadata.push(record);
    else if (record.type === "Message") {
      const channel = this.channels.get(record.channelId);
      if (!this.readers.has(channel.id)) this.readers.set(channel.id, decoderOf(this.schemas.get(channel.schemaId)));
      if (!this.messages.has(channel.topic)) this.messages.set(channel.topic, []);
      this.messages.get(channel.topic).push({
        logTime: record.logTime,
        publishTime: record.publishTime,
        value: this.readers.get(channel.id).readMessage(record.data),
      });
    }
  }
  of(topic) {
    return this.messages.get(topic) ?? [];
  }
}

const handlers = await loadDecompressHandlers();

// CRC-32 as zlib has it.
const crcTable = Uint32Array.from({ length: 256 }, (_, byte) => {
  let value = byte;
  for (let bit = 0; bit < 8; ++bit) value = value & 1 ? 0xedb88320 ^ (value >>> 1) : value >>> 1;
  return value;
});
const crc32 = (bytes) => (bytes.reduce((crc, byte) => crcTable[(crc ^ byte) & 255] ^ (crc >>> 8), 0xffffffff) ^ 0xffffffff) >>> 0;

// The reader checks chunks and attachments, not the sums over the sections.
function checkSections(bytes) {
  const magic = 8;
  const head = 9;
  const footer = bytes.length - magic - head - 20;
  const summaryStart = Number(bytes.readBigUInt64LE(footer + head));
  const dataEnd = summaryStart - head - 4;
  check(bytes[dataEnd] === 0x0f && bytes.readUInt32LE(dataEnd + head) === crc32(bytes.subarray(0, dataEnd)), "the data section has its checksum");
  check(bytes.readUInt32LE(footer + head + 16) === crc32(bytes.subarray(summaryStart, footer + head + 16)), "the summary has its checksum");
}

function stream(bytes) {
  const reader = new McapStreamReader({ decompressHandlers: handlers, validateCrcs: true });
  const collected = new Collector();
  for (let at = 0; at < bytes.length; at += 65536) {
    reader.append(bytes.subarray(at, at + 65536));
    for (let record; (record = reader.nextRecord()); ) collected.add(record);
  }
  check(reader.done(), "the stream ends with a footer");
  return collected;
}

async function indexed(bytes) {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size))),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers: handlers });
  const collected = new Collector();
  for (const schema of reader.schemasById.values()) collected.add(schema);
  for (const channel of reader.channelsById.values()) collected.add(channel);
  for await (const message of reader.readMessages({ validateCrcs: true })) collected.add(message);
  for await (const attachment of reader.readAttachments()) collected.add(attachment);
  for await (const metadata of reader.readMetadata()) collected.add(metadata);
  const counted = [...reader.statistics.channelMessageCounts].reduce((sum, [, count]) => sum + Number(count), 0);
  check(counted === Number(reader.statistics.messageCount), "statistics agree with themselves");
  const total = [...collected.messages.values()].reduce((sum, list) => sum + list.length, 0);
  check(total === counted, `all ${counted} messages of the statistics are found through the index`);
  return collected;
}

function checkTicks(ticks, whole) {
  check(whole ? ticks.length === rows.length : ticks.length > 0 && ticks.length < rows.length, `${ticks.length} ticks of ${rows.length}`);
  let unequal = 0;
  ticks.forEach(({ value }, k) => {
    const numbers = numbersOf(value);
    unequal += numbers.length !== header.length || !rows[k].every((cell, i) => sameNumber(cell, numbers[i]));
  });
  check(unequal === 0, `every value of every tick equals ticks.csv to the last bit (${header.length} columns)`);
  const late = ticks.filter(({ publishTime }, k) => Math.abs(Number(publishTime - ticks[0].publishTime) - Math.round(1e9 * Number(rows[k][0]))) > 1);
  check(late.length === 0, "the time of publication is that of the loop");
}

function checkJoints(states) {
  const column = (name) => header.indexOf(name);
  const bad = states.filter(({ value, logTime }, k) => {
    const cells = (stem, unit) => [1, 2].map((joint) => rows[k][column(`${stem}${joint}_${unit}`)]);
    const stamp = BigInt(value.header.stamp.sec) * 1000000000n + BigInt(value.header.stamp.nsec ?? value.header.stamp.nanosec);
    return !(
      isDeepStrictEqual(value.name, ["joint_1", "joint_2"]) && stamp === logTime &&
      [["position", "q", "rad"], ["velocity", "dq", "rad_s"], ["effort", "tau", "Nm"]].every(([field, stem, unit]) =>
        cells(stem, unit).every((cell, joint) => sameNumber(cell, value[field][joint])))
    );
  });
  check(states.length > 0 && bad.length === 0, `${states.length} joint states equal ticks.csv`);
}

function checkFrames(frames, whole) {
  check(whole ? frames.length === logged.length : frames.length > 0, `${frames.length} frames of ${logged.length}`);
  const bad = frames.filter(({ value, logTime }, k) => {
    const [, seconds, micros, channel, id, data] = logged[k];
    const bytes = Buffer.from(value.data.slice(0, value.dlc)).toString("hex").toUpperCase();
    return !(
      value.header.frame_id === channel && value.id === parseInt(id, 16) && value.is_extended === (id.length === 8) &&
      !value.is_rtr && !value.is_error && bytes === data && logTime / 1000n === BigInt(seconds) * 1000000n + BigInt(micros)
    );
  });
  check(bad.length === 0, "every frame equals its line of frames.log, its stamp to the microsecond");
}

function checkTiming(timing, whole) {
  const quantity = header.indexOf("execution_us");
  const bad = timing.filter(({ value }) => {
    const own = rows.filter((row) => Math.floor(Number(row[0])) === value.t_s);
    const longest = Math.max(...own.map((row) => Number(row[quantity])));
    const counted = [...value.execution_count].reduce((a, b) => a + b, 0);
    return value.ticks > own.length || (whole && value.ticks !== own.length) || counted !== value.ticks || Math.abs(value.execution_max_us - longest) > 1e-9;
  });
  check(timing.length > 0 && bad.length === 0, `the timing of ${timing.length} seconds counts the ticks of ticks.csv`);
}

function checkRest(collected, whole) {
  const texts = collected.of("/patella/events").map(({ value }) => value.msg);
  check(isDeepStrictEqual(texts, whole ? events : events.slice(0, texts.length)), `${texts.length} events are the lines of events.log`);
  const hash = (bytes) => createHash("sha256").update(bytes).digest("hex");
  const known = new Set(inputs.map((file) => path.basename(file) + hash(fs.readFileSync(file))));
  const attached = new Set(collected.attachments.map(({ name, data }) => name + hash(data)));
  check([...known].every((file) => attached.has(file)), `${known.size} files that the run was configured from are attached as they are`);
  const metadata = new Map(collected.metadata.map(({ name, metadata: values }) => [name, values]));
  const hashes = [...(metadata.get("inputs")?.values() ?? [])].join(" ");
  check(inputs.every((file) => hashes.includes(hash(fs.readFileSync(file)))), "their hashes are in the metadata");
  if (whole) check(metadata.get("summary")?.get("summary.json") === summary, "so is the summary");
}

for (const [file, kind] of files) {
  const bytes = fs.readFileSync(file);
  const whole = kind === "whole";
  checkSections(bytes);
  for (const [way, collected] of [["as a stream", stream(bytes)], ["through its index", await indexed(bytes)]]) {
    console.log(`-- ${path.basename(file)}, ${way}`);
    checkTicks(collected.of("/patella/tick"), whole);
    checkJoints(collected.of("/joint_states"));
    checkFrames(collected.of("/patella/can"), whole);
    checkTiming(collected.of("/patella/timing"), whole);
    checkRest(collected, whole);
  }
}
process.exit(failures === 0 ? 0 : 1);
