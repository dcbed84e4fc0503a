// Prints an MCAP file like `sonopose-mcap cat`, with third-party decoders: node mcap_lines.cjs FILE
// Needs the packages @mcap/core, @foxglove/omgidl-parser and @foxglove/omgidl-serialization in NODE_PATH, and
// @mcap/support for compressed files.
const { open } = require("node:fs/promises");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { parseIDL } = require("@foxglove/omgidl-parser");
const { MessageReader } = require("@foxglove/omgidl-serialization");

// Converts 64-bit integers (BigInt) and typed arrays, which JSON.stringify does not support.
function json(value) {
  if (typeof value === "bigint") return value.toString();
  if (value instanceof JsonText) return value.text;
  if (ArrayBuffer.isView(value)) return json(Array.from(value));
  if (Array.isArray(value)) return "[" + value.map(json).join(",") + "]";
  if (value !== null && typeof value === "object") {
    return "{" + Object.entries(value).map(([key, field]) => JSON.stringify(key) + ":" + json(field)).join(",") + "}";
  }
  return JSON.stringify(value);
}

// JSON text kept verbatim, because parsing would round 64-bit integers.
class JsonText {
  constructor(text) {
    JSON.parse(text);
    this.text = text;
  }
}

function decoder(schema, channel) {
  const text = new TextDecoder();
  if (channel.messageEncoding === "json") return (data) => new JsonText(text.decode(data));
  const reader = new MessageReader(schema.name, parseIDL(text.decode(schema.data)));
  return (data) => reader.readMessage(data);
}

function line(channel, message, decode) {
  return json({
    topic: channel.topic,
    sequence: message.sequence,
    log_time_ns: message.logTime,
    publish_time_ns: message.publishTime,
    message: decode(message.data),
  });
}

async function decompressors() {
  try {
    return await require("@mcap/support").loadDecompressHandlers();
  } catch {
    return {}; // for files without compression
  }
}

async function main(name) {
  const file = await open(name);
  const { size } = await file.stat();
  const readable = {
    size: async () => BigInt(size),
    read: async (offset, length) => {
      const bytes = new Uint8Array(Number(length));
      await file.read(bytes, 0, Number(length), Number(offset));
      return bytes;
    },
  };
  const decompressHandlers = await decompressors();
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const decoders = new Map();
  for (const [id, channel] of reader.channelsById) {
    decoders.set(id, decoder(reader.schemasById.get(channel.schemaId), channel));
  }
  let indexed = 0;
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    console.log(line(channel, message, decoders.get(message.channelId)));
    ++indexed;
  }
  // Reads from start to end and checks every checksum.
  const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  stream.append(await readable.read(0n, BigInt(size)));
  let streamed = 0;
  for (let record; (record = stream.nextRecord()) != null; ) {
    if (record.type === "Message") ++streamed;
  }
  if (!stream.done()) throw new Error("the stream reader is not at the end");
  if (streamed !== indexed) throw new Error(`${indexed} messages by the index, ${streamed} from start to end`);
}

main(process.argv[2]).catch((error) => {
  console.error(error);
  process.exit(1);
});
