// Our data sheet after CiA 306 in a reader of another author (npm canopen): every object with its name, type, access and
// value; then that author's writing of it goes to a file, for our reader.
//
//   node sheet.cjs NPM_FOLDER EDS WRITTEN
"use strict";
const Module = require("module");
const fs = require("fs");
const path = require("path");

const [npm, sheet, written] = process.argv.slice(2);
const load = Module._load;
Module._load = (name, ...rest) => (name === "node-crc" ? { crc() { return Buffer.alloc(2); } } : load(name, ...rest));
const { Eds } = require(path.join(npm, "node_modules", "canopen"));

let failures = 0;
function check(holds, what) {
  if (!holds) {
    console.log(`FAILS  ${what}`);
    failures += 1;
  }
}

// A second reading, line by line: section by section, key by key.
const sections = {};
let section;
for (const line of fs.readFileSync(sheet, "utf8").split("\n")) {
  const head = line.match(/^\[(.+)\]$/);
  const pair = line.match(/^([^;=]+)=(.*)$/);
  if (head) section = sections[head[1]] = {};
  else if (pair) section[pair[1].trim()] = pair[2].trim();
}

const eds = Eds.fromFile(sheet);
check(eds.vendorName === sections.DeviceInfo.VendorName, "vendor's name");
check(eds.productName === sections.DeviceInfo.ProductName, "product's name");
let objects = 0;
let values = 0;
for (const [name, keys] of Object.entries(sections)) {
  const place = name.match(/^([0-9A-F]{4})(?:sub([0-9A-F]+))?$/i);
  if (!place) continue;
  const index = parseInt(place[1], 16);
  const entry = place[2] === undefined ? eds.getEntry(index) : eds.getSubEntry(index, parseInt(place[2], 16));
  check(entry !== undefined, `[${name}] is not read`);
  if (entry === undefined) continue;
  objects += 1;
  check(entry.parameterName === keys.ParameterName, `[${name}] is called ${entry.parameterName}`);
  if (keys.DataType !== undefined) check(entry.dataType === Number(keys.DataType), `[${name}] has type ${entry.dataType}`);
  if (keys.AccessType !== undefined) check(entry.accessType === keys.AccessType, `[${name}] has access ${entry.accessType}`);
  // The package reads no formula with $NODEID, and counts the entries of a mapping that are there instead of those in use.
  const counted = /^1[6A]00sub0$/.test(name);
  if (keys.DefaultValue !== undefined && !counted && /^-?(0x)?[0-9A-F]+$/i.test(keys.DefaultValue)) {
    values += 1;
    check(Number(entry.value) === Number(keys.DefaultValue), `[${name}] is ${entry.value}, expected ${keys.DefaultValue}`);
  }
}
check(objects > 30 && values > 20, `only ${objects} objects and ${values} values`);
// It writes sections only that were read, and these two are optional.
eds.dummyUsage ??= {};
eds.comments ??= {};
eds.save(written);
console.log(`ok     ${objects} objects and ${values} values of ${path.basename(sheet)} read by npm canopen`);
process.exit(failures === 0 ? 0 : 1);
