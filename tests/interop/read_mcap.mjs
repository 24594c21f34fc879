// Reads an MCAP with @mcap/core and @foxglove/rosmsg2-serialization and prints every message as a line of JSON.
// Usage: node read_mcap.mjs FILE [--unfinished]   (the two packages installed beside it or in NODE_PATH)
import { createRequire } from "node:module";
import { open } from "node:fs/promises";
const require = createRequire(process.env.INTEROP_MODULES ? process.env.INTEROP_MODULES + "/" : import.meta.url);
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const zstd = require("@foxglove/wasm-zstd");
await zstd.isLoaded;
const decompressHandlers = { zstd: (buffer, size) => zstd.decompress(buffer, Number(size)) };

const plain = (key, value) => {
  if (typeof value === "bigint") return value.toString();
  if (typeof value === "number" && !Number.isFinite(value)) return String(value);
  if (ArrayBuffer.isView(value)) return Array.from(value, (v) => (Number.isFinite(v) ? v : String(v)));
  return value;
};

const handle = await open(process.argv[2]);
const { size } = await handle.stat();
const readable = {
  size: async () => BigInt(size),
  read: async (offset, length) => {
    const bytes = new Uint8Array(Number(length));
    await handle.read(bytes, 0, Number(length), Number(offset));
    return bytes;
  },
};
if (process.argv[3] === "--unfinished") {
  // A recording that was cut off: no index, whole records from the front, checksums checked.
  const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  stream.append(await readable.read(0n, BigInt(size)));
  const channels = new Map(), schemas = new Map(), parsers = new Map();
  for (let record; (record = stream.nextRecord()); ) {
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type !== "Message") continue;
    const channel = channels.get(record.channelId), schema = schemas.get(channel.schemaId);
    if (!parsers.has(schema.id)) parsers.set(schema.id, new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true })));
    const content = parsers.get(schema.id).readMessage(record.data);
    console.log(JSON.stringify({ topic: channel.topic, type: schema.name, log_time: record.logTime, content }, plain));
  }
  process.exit(0);
}
const indexed = await McapIndexedReader.Initialize({ readable, decompressHandlers });
const readers = new Map();
let count = 0;
for await (const message of indexed.readMessages()) {
  const channel = indexed.channelsById.get(message.channelId);
  const schema = indexed.schemasById.get(channel.schemaId);
  if (!readers.has(schema.id)) {
    readers.set(schema.id, new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true })));
  }
  const content = readers.get(schema.id).readMessage(message.data);
  count++;
  console.log(JSON.stringify({ topic: channel.topic, type: schema.name, log_time: message.logTime, content }, plain));
}
// The same once more without the index: every record in the file's order, checksums checked.
const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(await readable.read(0n, BigInt(size)));
let streamed = 0;
for (let record; (record = stream.nextRecord()); ) if (record.type === "Message") streamed++;
const stated = Number(indexed.statistics.messageCount);
if (streamed !== count || stated !== count) throw new Error(`indexed ${count}, streamed ${streamed}, stated ${stated}`);
