// Connects to sonopose-web as Foxglove does, with a third-party client and decoders:
//   node foxglove_client.cjs URL SUB_PROTOCOL
// Prints JSON lines: the server's info and channels, ten decoded poses and the latest settings, a status for a wrong
// subscription, and the number of poses received after their unsubscription.
// Needs the packages @foxglove/ws-protocol, @foxglove/omgidl-parser, @foxglove/omgidl-serialization and ws in
// NODE_PATH.
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { parseIDL } = require("@foxglove/omgidl-parser");
const { MessageReader } = require("@foxglove/omgidl-serialization");
const WebSocket = require("ws");

const [url, subProtocol] = process.argv.slice(2);

function print(kind, content) {
  console.log(JSON.stringify({ kind, ...content }, (_key, value) => (typeof value === "bigint" ? value.toString() : value)));
}

const socket = new WebSocket(url, [subProtocol]);
const client = new FoxgloveClient({ ws: socket });
const subscriptions = new Map(); // topic and decoder by subscription
let poses = 0;
let settings = 0;
let unsubscribedAt = 0;
let posesAfterwards = 0;

function fail(error) {
  console.error(String(error));
  process.exit(1);
}

client.on("error", fail);
client.on("close", () => fail("the connection was closed"));
client.on("serverInfo", (info) => print("info", { protocol: socket.protocol, ...info }));
client.on("status", (status) => print("status", status));

client.on("advertise", (channels) => {
  print("channels", { topics: channels.map((channel) => channel.topic) });
  for (const channel of channels) {
    const isWanted = ["sonopose/pose", "sonopose/settings"].includes(channel.topic);
    if (channel.encoding !== "cdr" || channel.schemaEncoding !== "omgidl") fail(`${channel.topic}: not CDR with an IDL`);
    const reader = new MessageReader(channel.schemaName, parseIDL(channel.schema)); // checks that every schema is readable
    if (!isWanted) continue;
    subscriptions.set(client.subscribe(channel.id), { topic: channel.topic, reader });
  }
  client.subscribe(99999);
});

client.on("message", ({ subscriptionId, timestamp, data }) => {
  const { topic, reader } = subscriptions.get(subscriptionId);
  const message = reader.readMessage(data);
  if (topic === "sonopose/pose") {
    if (unsubscribedAt > 0) return void ++posesAfterwards;
    if (++poses > 10) {
      client.unsubscribe(subscriptionId);
      unsubscribedAt = Date.now();
      return;
    }
  } else {
    ++settings;
  }
  print("message", { topic, timestamp, message });
});

client.on("time", ({ timestamp }) => {
  print("time", { timestamp });
  // Messages in transit are allowed; after two seconds there must be none.
  if (settings > 0 && unsubscribedAt > 0 && Date.now() - unsubscribedAt > 2000) {
    print("end", { posesAfterwards });
    process.exit(0);
  }
});

setTimeout(() => fail(`after 20 s: ${poses} poses, ${settings} settings`), 20000);
