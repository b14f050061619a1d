// Messages of ROS 2: a decoder made from the definition that comes with a channel, and what a tick's definition names.
"use strict";
const SIZES = { bool: 1, byte: 1, uint8: 1, int32: 4, uint32: 4, float64: 8 };

class CdrReader {
  constructor(view, start) {
    this.view = view;
    this.start = start + 4; // behind the encapsulation
    this.at = this.start;
  }
  number(type) {
    const size = SIZES[type];
    const past = (this.at - this.start) % size;
    if (past !== 0) this.at += size - past;
    const at = this.at;
    this.at += size;
    if (type === "float64") return this.view.getFloat64(at, true);
    if (type === "int32") return this.view.getInt32(at, true);
    return size === 4 ? this.view.getUint32(at, true) : this.view.getUint8(at);
  }
  text() {
    const length = this.number("uint32");
    const bytes = new Uint8Array(this.view.buffer, this.view.byteOffset + this.at, Math.max(length - 1, 0));
    this.at += length;
    return new TextDecoder().decode(bytes);
  }
}

/** Fields of the first type of a definition, and its constants: "float64[2] q_rad", "uint8 STATE_INIT=0". */
function parseDefinition(text) {
  const fields = [];
  const constants = new Map();
  for (const line of text.split("\n")) {
    if (line.startsWith("===")) break;
    const words = line.replace(/#.*/, "").trim();
    const constant = /^\w+ (\w+)=(\d+)$/.exec(words);
    const field = /^([\w/]+)(\[(\d*)\])? (\w+)$/.exec(words);
    if (constant) constants.set(constant[1], Number(constant[2]));
    else if (field) fields.push({ type: field[1], array: field[2] !== undefined, count: Number(field[3] || 0), name: field[4] });
  }
  return { fields, constants };
}

/** Decodes messages whose fields are numbers, texts, times, and arrays of numbers. */
class Decoder {
  constructor(definition) {
    Object.assign(this, parseDefinition(definition));
  }
  decode(view, start) {
    const reader = new CdrReader(view, start);
    const message = {};
    for (const { type, array, count, name } of this.fields) {
      if (array) {
        const length = count || reader.number("uint32");
        message[name] = Array.from({ length }, () => reader.number(type));
      } else if (type === "builtin_interfaces/Time") {
        message[name] = reader.number("int32") + 1e-9 * reader.number("uint32");
      } else {
        message[name] = type === "string" ? reader.text() : reader.number(type);
      }
    }
    return message;
  }
}

/** Decodes ticks into rows with a number for each column of ticks.csv: they are many. */
class TickDecoder {
  constructor(definition, columns) {
    const { fields, constants } = parseDefinition(definition);
    this.columns = columns;
    this.types = fields.flatMap(({ type, array, count }) => new Array(array ? count : 1).fill(type));
    if (this.types.length !== columns.length) throw new Error(`${this.types.length} numbers for ${columns.length} columns`);
    const named = (prefix) =>
      [...constants].filter(([name]) => name.startsWith(prefix)).map(([name, value]) => [value, name.slice(prefix.length).toLowerCase()]);
    this.states = new Map(named("STATE_"));
    this.faults = named("FAULT_");
  }
  decode(view, start, row) {
    const reader = new CdrReader(view, start);
    for (let i = 0; i < this.types.length; ++i) row[i] = reader.number(this.types[i]);
  }
}
