// Prints each MAVLink message of a file of raw bytes as a line of JSON, with a third-party decoder:
// node mavlink_lines.cjs FILE. Needs the package node-mavlink in NODE_PATH.
const { createReadStream } = require("node:fs");
const { MavLinkPacketParser, MavLinkPacketSplitter, common, minimal } = require("node-mavlink");

const registry = { ...minimal.REGISTRY, ...common.REGISTRY };

// JSON has neither NaN nor 64-bit integers.
const plain = (_key, value) =>
  typeof value === "bigint" ? value.toString() : Number.isNaN(value) ? "NaN" : value;

createReadStream(process.argv[2])
  .pipe(new MavLinkPacketSplitter())
  .pipe(new MavLinkPacketParser())
  .on("data", (packet) => {
    const type = registry[packet.header.msgid];
    const { magic, seq, sysid, compid, msgid } = packet.header;
    const data = packet.protocol.data(packet.payload, type);
    console.log(JSON.stringify({ name: type.MSG_NAME, magic, seq, sysid, compid, msgid, data }, plain));
  });
