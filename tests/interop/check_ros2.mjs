// Judges the ROS 2 messages by other hands: definitions against those that ROS publishes (@foxglove/rosmsg-msgs-common),
// bytes by reading them with these definitions and writing them again (@foxglove/rosmsg2-serialization).
// Usage: node check_ros2.mjs PRINT_ROS2; exit 77 (skipped) with one line where the packages are missing.
import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { existsSync } from "node:fs";
import { createRequire } from "node:module";
import { fileURLToPath } from "node:url";

const modules = process.env.INTEROP_MODULES ?? fileURLToPath(new URL("../../build/interop", import.meta.url));
if (!existsSync(modules + "/node_modules/@foxglove/rosmsg-msgs-common")) {
  console.log(`skipped: ${modules} holds no node_modules with @foxglove/rosmsg-msgs-common ($INTEROP_MODULES)`);
  process.exit(77);
}
const require = createRequire(modules + "/");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader, MessageWriter } = require("@foxglove/rosmsg2-serialization");
const { ros2humble } = require("@foxglove/rosmsg-msgs-common");

const field = (name, type, isArray = false) => ({ name, type, isArray, isComplex: true });
const published = new Map(Object.entries(ros2humble));
// Of nav2, which that package does not have.
published.set("nav2_msgs/Particle", { name: "nav2_msgs/Particle",
  definitions: [field("pose", "geometry_msgs/Pose"), { name: "weight", type: "float64", isArray: false, isComplex: false }] });
published.set("nav2_msgs/ParticleCloud", { name: "nav2_msgs/ParticleCloud",
  definitions: [field("header", "std_msgs/Header"), field("particles", "nav2_msgs/Particle", true)] });

const short = (type) => type.replace("/msg/", "/");
const lookup = (type) => published.get(type) ?? published.get(type.replace("/", "/msg/"));
const plain = (type) => (type === "builtin_interfaces/Time" ? "time" : type === "byte" ? "uint8" : short(type));
// What a type is made of, all levels, constants left out.
const layout = (type) => {
  const found = lookup(type);
  if (!found) throw new Error(`${type}: nobody publishes it`);
  return found.definitions.filter((f) => !f.isConstant).map((f) => describe(f, layout));
};
const describe = (f, inner) => {
  const type = plain(f.type);
  const what = f.isComplex && type !== "time" ? inner(type) : type;
  return [f.name, what, f.isArray ? (f.arrayLength ?? "[]") : ""];
};
const closure = (type, out = new Map()) => {
  if (out.has(type)) return out;
  const found = lookup(type);
  out.set(type, { name: type, definitions: found.definitions });
  for (const f of found.definitions) if (f.isComplex && plain(f.type) !== "time") closure(plain(f.type), out);
  return out;
};

// The hash of a published type, by REP 2011 as rosidl computes it.
const kinds = { int8: 2, uint8: 3, int32: 6, uint32: 7, float32: 10, float64: 11, byte: 16, string: 17 };
const long = (type) => (type.includes("/msg/") ? type : type.replace("/", "/msg/"));
const json = (value) =>
  Array.isArray(value) ? `[${value.map(json).join(", ")}]`
  : typeof value === "object" ? `{${Object.entries(value).map(([k, v]) => `${JSON.stringify(k)}: ${json(v)}`).join(", ")}}`
  : JSON.stringify(value);
const hashOf = (type) => {
  const parts = closureWithTime(type);
  const described = (name) => ({ type_name: long(name), fields: parts.get(name).map((f) => {
    const complex = !(f.type in kinds);
    const capacity = f.isArray ? f.arrayLength ?? 0 : 0;
    const offset = !f.isArray ? 0 : f.arrayLength ? 48 : 144;
    return { name: f.name, type: { type_id: (complex ? 1 : kinds[f.type]) + offset, capacity, string_capacity: 0,
      nested_type_name: complex ? long(f.type) : "" } };
  }) });
  const others = [...parts.keys()].filter((name) => name !== type).sort((a, b) => (long(a) < long(b) ? -1 : 1));
  return "RIHS01_" + createHash("sha256")
    .update(json({ type_description: described(type), referenced_type_descriptions: others.map(described) })).digest("hex");
};
const closureWithTime = (type, out = new Map()) => {
  if (out.has(type)) return out;
  const fields = type === "builtin_interfaces/Time"
    ? [{ name: "sec", type: "int32" }, { name: "nanosec", type: "uint32" }]
    : lookup(type).definitions.filter((f) => !f.isConstant).map((f) => ({ ...f, type: f.type === "time" ? "builtin_interfaces/Time"
        : type === "diagnostic_msgs/DiagnosticStatus" && f.name === "level" ? "byte" : short(f.type) }));
  out.set(type, fields);
  for (const f of fields) if (!(f.type in kinds)) closureWithTime(f.type, out);
  return out;
};

let hashes = 0, types = 0, messages = 0;
const tools = new Map();
for (const line of execFileSync(process.argv[2], { encoding: "utf8", maxBuffer: 1 << 28 }).trim().split("\n")) {
  const [kind, name, hex] = line.split(" ");
  const type = short(name), bytes = Buffer.from(hex, "hex");
  if (kind === "hash") {
    if (hashOf(type) !== hex) throw new Error(`${type}: published as ${hashOf(type)}, ours is ${hex}`);
    hashes++;
    continue;
  }
  if (kind === "definition") {
    const ours = parse(bytes.toString(), { ros2: true });
    const named = new Map(ours.filter((d) => d.name).map((d) => [d.name, d]));
    const main = ours.find((d) => !d.name || d.name === type);
    const describeOurs = (d) => d.definitions.map((f) => describe(f, (t) => describeOurs(named.get(t))));
    const want = JSON.stringify(layout(type)), got = JSON.stringify(describeOurs(main));
    if (want !== got) throw new Error(`${type}: published as ${want}, ours is ${got}`);
    const definitions = [...closure(type).values()].map((d, i) => (i === 0 ? { definitions: d.definitions } : d));
    tools.set(type, [new MessageReader(definitions), new MessageWriter(definitions)]);
    types++;
    continue;
  }
  const [reader, writer] = tools.get(type);
  const again = Buffer.from(writer.writeMessage(reader.readMessage(bytes)));
  if (!again.equals(bytes)) throw new Error(`${type}: ${hex} was read and written as ${again.toString("hex")}`);
  messages++;
}
if (hashes < 11 || types < 11 || messages < 110) throw new Error(`${types} types, ${messages} messages: some are missing`);
console.log(`${types} types as ROS publishes them, ${messages} messages read and written again to the same bytes`);
