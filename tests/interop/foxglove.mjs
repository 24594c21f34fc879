// Reads a live run as Foxglove's own client does: scans, frames, map, path, status; says where the robot stands; offers
// either subprotocol and none. Usage: node foxglove.mjs PHASESCAN; exit 77 where @foxglove/ws-protocol is not installed.
import { spawn } from "node:child_process";
import { existsSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const modules = process.env.INTEROP_MODULES ?? join(dirname(fileURLToPath(import.meta.url)), "../../build/interop");
if (!existsSync(join(modules, "node_modules/@foxglove/ws-protocol"))) {
  console.log(`skipped: ${modules} holds no node_modules with @foxglove/ws-protocol ($INTEROP_MODULES)`);
  process.exit(77);
}
const require = createRequire(modules + "/");
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { WebSocket } = require("ws");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader, MessageWriter } = require("@foxglove/rosmsg2-serialization");

const check = (what, good) => {
  if (!good) throw new Error("not so: " + what);
};
const within = (seconds, what, promise) =>
  Promise.race([promise, new Promise((_, reject) => setTimeout(() => reject(new Error("waited for " + what)), 1000 * seconds))]);

const live = spawn(process.argv[2], ["live", "--demo", "--serve", "127.0.0.1:0"], { stdio: ["ignore", "ignore", "pipe"] });
let said = "";
const url = await within(20, "the address", new Promise((resolve, reject) => {
  live.stderr.on("data", (data) => {
    said += data;
    const found = said.match(/open http:\/\/(\S+?)\//);
    if (found) resolve(`ws://${found[1]}/foxglove`);
  });
  live.once("exit", () => reject(new Error("live ended: " + said)));
}));

/// A client with what it was told, and what came on each topic it wants.
function connect(subprotocol, wanted) {
  const socket = new WebSocket(url, [subprotocol]);
  const client = new FoxgloveClient({ ws: socket });
  const seen = { channels: new Map(), messages: new Map(), statuses: [], times: [], info: null, errors: [] };
  const readers = new Map(), topics = new Map();
  client.on("serverInfo", (info) => (seen.info = info));
  client.on("error", (error) => seen.errors.push(error));
  client.on("status", (status) => seen.statuses.push(status));
  client.on("time", (time) => seen.times.push(time.timestamp));
  client.on("advertise", (channels) => {
    for (const channel of channels) {
      seen.channels.set(channel.topic, channel);
      if (!wanted.includes(channel.topic)) continue;
      const id = client.subscribe(channel.id);
      topics.set(id, channel.topic);
      readers.set(id, new MessageReader(parse(channel.schema, { ros2: true })));
    }
  });
  client.on("message", (message) => {
    const topic = topics.get(message.subscriptionId);
    if (!seen.messages.has(topic)) seen.messages.set(topic, []);
    seen.messages.get(topic).push({ time: message.timestamp, ...readers.get(message.subscriptionId).readMessage(message.data) });
  });
  const until = (what, condition, seconds = 90) => within(seconds, what, new Promise((resolve) => {
    const timer = setInterval(() => condition() && (clearInterval(timer), resolve()), 20);
  }));
  return { client, socket, seen, until };
}

try {
  const wanted = ["/scan", "/tf", "/tf_static", "/map", "/path", "/pose", "/status", "/diagnostics"];
  const first = connect("foxglove.sdk.v1", wanted);
  const { seen } = first;
  await first.until("all topics", () => wanted.every((topic) => seen.messages.has(topic)));
  check("sdk.v1 was chosen", first.socket.protocol === "foxglove.sdk.v1");
  check("capabilities", seen.info.capabilities.includes("clientPublish") && seen.info.capabilities.includes("time"));
  const scan = seen.messages.get("/scan")[0], hits = scan.ranges.filter((r) => r > scan.range_min && r < scan.range_max).length;
  check("a scan of 360 beams in the frame laser", scan.ranges.length === 360 && scan.header.frame_id === "laser" && hits > 180);
  const frames = new Set(["/tf", "/tf_static"].flatMap((t) => seen.messages.get(t)).flatMap((m) => m.transforms).map((t) => `${t.header.frame_id} ${t.child_frame_id}`));
  check("frames", ["map odom", "odom base_link", "base_link laser"].every((edge) => frames.has(edge)));
  const count = (message, value) => message.data.reduce((n, cell) => n + (cell === value), 0);
  await first.until("a map that grows", () => count(seen.messages.get("/map").at(-1), 100) > 50);
  const map = seen.messages.get("/map").at(-1), cells = Array.from(map.data);
  check(`a map with free space: ${map.info.width} x ${map.info.height}, ${count(map, 100)}, ${count(map, 0)}, ${count(map, -1)}`, map.info.width * map.info.height === cells.length && map.header.frame_id === "map" &&
    count(map, 0) > 1000 && cells.every((c) => [-1, 0, 100].includes(c)));
  // The hits of the scan lie on walls of the map: frames, signs and origin are right.
  const pose = seen.messages.get("/pose").at(-1), last = seen.messages.get("/scan").at(-1);
  const heading = 2 * Math.atan2(pose.pose.pose.orientation.z, pose.pose.pose.orientation.w);
  let on = 0, all = 0;
  last.ranges.forEach((range, i) => {
    if (!(range > last.range_min && range < last.range_max)) return;
    const angle = heading + last.angle_min + i * last.angle_increment;
    const x = (pose.pose.pose.position.x + range * Math.cos(angle) - map.info.origin.position.x) / map.info.resolution;
    const y = (pose.pose.pose.position.y + range * Math.sin(angle) - map.info.origin.position.y) / map.info.resolution;
    all++;
    for (let dx = -1, found = false; dx <= 1 && !found; dx++) for (let dy = -1; dy <= 1 && !found; dy++)
      if (cells[(Math.floor(y) + dy) * map.info.width + Math.floor(x) + dx] === 100) (found = true), on++;
  });
  check(`hits on walls: ${on} of ${all}`, on > 0.6 * all);
  check("covariance", pose.pose.covariance[0] > 0 && pose.pose.covariance[35] > 0);
  check("status", seen.messages.get("/status").at(-1).data === "ok" && seen.messages.get("/diagnostics").at(-1).status[0].message === "ok");
  check("time goes on", seen.times.length > 3 && seen.times.at(-1) > seen.times[0]);
  check("path", seen.messages.get("/path").at(-1).poses.length > 0);

  // A person drags the pose: the answer is a status.
  const definition = parse("std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n" +
    "=".repeat(80) + "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" +
    "=".repeat(80) + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n" +
    "=".repeat(80) + "\nMSG: geometry_msgs/PoseWithCovariance\ngeometry_msgs/Pose pose\nfloat64[36] covariance\n" +
    "=".repeat(80) + "\nMSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n" +
    "=".repeat(80) + "\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n" +
    "=".repeat(80) + "\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n", { ros2: true });
  const estimate = { header: { stamp: { sec: 1, nanosec: 0 }, frame_id: "map" }, pose: { pose: { ...pose.pose.pose }, covariance: new Array(36).fill(0) } };
  const channel = first.client.advertise({ topic: "/initialpose", encoding: "cdr", schemaName: "geometry_msgs/msg/PoseWithCovarianceStamped" });
  first.client.sendMessage(channel, new MessageWriter(definition).writeMessage(estimate));
  await first.until("an answer to the pose", () => seen.statuses.length > 0, 20);
  check("the answer is a line: " + JSON.stringify(seen.statuses), seen.statuses.length === 1 && seen.statuses[0].message.length > 5);
  const before = seen.messages.get("/scan").length;
  await first.until("scans after it", () => seen.messages.get("/scan").length > before + 3);
  check("no error in the client: " + seen.errors.join("; "), seen.errors.length === 0);

  const older = connect("foxglove.websocket.v1", ["/map", "/tf_static"]);
  await older.until("what stays, at once", () => older.seen.messages.size === 2, 15);
  check("websocket.v1 was chosen", older.socket.protocol === "foxglove.websocket.v1");
  const both = new WebSocket(url, ["foxglove.websocket.v1", "foxglove.sdk.v1"]);
  await within(10, "a third client", new Promise((done) => both.once("open", done)));
  check("of both, sdk.v1 is chosen", both.protocol === "foxglove.sdk.v1");
  const stranger = new WebSocket(url, ["chat"]);
  const refused = await within(10, "a refusal", new Promise((done) => {
    stranger.once("error", () => done(true));
    stranger.once("open", () => done(false));
  }));
  check("an unknown subprotocol is refused", refused);
  const foreign = new WebSocket(url, ["foxglove.sdk.v1"], { origin: "https://evil.example.org" });
  check("a foreign page is refused", await within(10, "a refusal", new Promise((done) => {
    foreign.once("error", () => done(true));
    foreign.once("open", () => done(false));
  })));
  const app = new WebSocket(url, ["foxglove.sdk.v1"], { origin: "https://app.foxglove.dev" });
  await within(10, "Foxglove's page", new Promise((done, no) => (app.once("open", done), app.once("error", no))));
  for (const socket of [first.socket, older.socket, both, app]) socket.close();
  console.log(`@foxglove/ws-protocol: ${seen.messages.get("/scan").length} scans, map ${map.info.width} x ${map.info.height}, ${on} of ${all} hits on its walls; ` +
    `pose estimate answered: ${seen.statuses[0].message}`);
} finally {
  live.kill("SIGINT");
}
process.exit(0);
