// Watches a run in Chromium: the map grows, the robot's pose is dragged, map, state and a recording are saved, a log is moved
// through, the page finds the server again; on a known map the robot is found, lost, and told where it is. Usage: node live.mjs PHASESCAN [FOLDER for screenshots]
import { execFileSync, spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { check, open, page } from "./browser.mjs";

const [phasescan, shots] = process.argv.slice(2);
const browser = await open();
const folder = mkdtempSync(join(tmpdir(), "phasescan-live-"));
const running = new Set();

/// Starts `live` and waits for the address that it prints.
function live(...words) {
  return new Promise((resolve, reject) => {
    const child = spawn(phasescan, ["live", ...words, "--folder", folder], { stdio: ["ignore", "ignore", "pipe"] });
    let text = "";
    running.add(child);
    child.stderr.on("data", (data) => {
      text += data;
      const found = text.match(/open (http:\S+)/);
      if (found) resolve({ url: found[1], child, stop: () => new Promise((done) => { child.once("exit", done); child.kill("SIGINT"); }) });
    });
    child.once("exit", () => { running.delete(child); reject(new Error("live ended: " + text)); });
  });
}

const shot = (at, name) => shots && at.screenshot({ path: join(shots, name + ".png") });
const text = (at, id) => at.$eval("#" + id, (e) => e.textContent);
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
const known = (at) => at.evaluate(() => {
  let cells = 0;
  for (const tile of phasescan.world.state.tiles.values()) for (const byte of tile.packed) if (byte >> 4) cells += (byte & 15) + 1;
  return cells;
});
/// A page of the server may ask this server, and nobody else.
const visit = (url, width, height, options = {}) => page(browser, url, width, height, { from: new URL(url).origin.replace("http", "ws"), ...options });
const first_picture = (at) => at.waitForFunction(() => phasescan.view.frames > 0, { timeout: 20000 });

async function demo() {
  const run = await live("--demo", "--serve", "127.0.0.1:0");
  const at = await visit(run.url, 1280, 800, { expects: /WebSocket connection to .* failed/ });
  await first_picture(at);
  await at.waitForFunction(() => phasescan.world.state.tiles.size > 4, { timeout: 30000 });
  const early = await known(at);
  check("the state is said", (await text(at, "state-name")) === "Tracking");
  check("it is a demo", /demo/.test(await text(at, "state-source")));
  await at.waitForFunction((n) => {
    let cells = 0;
    for (const tile of phasescan.world.state.tiles.values()) for (const byte of tile.packed) if (byte >> 4) cells += (byte & 15) + 1;
    return cells > 1.2 * n;
  }, { timeout: 90000 }, early);
  await at.waitForFunction(() => phasescan.view.settled);
  await shot(at, "live-desktop");
  const pixels = await at.evaluate(() => {
    const c = document.getElementById("map"), data = c.getContext("2d").getImageData(0, 0, c.width, c.height).data, seen = new Map();
    for (let i = 0; i < data.length; i += 16) seen.set(data[i] + "," + data[i + 1] + "," + data[i + 2], 1 + (seen.get(data[i] + "," + data[i + 1] + "," + data[i + 2]) ?? 0));
    return { free: seen.get("255,255,255") ?? 0, walls: [...seen].filter(([k]) => +k.split(",")[0] < 90 && +k.split(",")[2] < 90).reduce((n, [, v]) => n + v, 0) };
  });
  check("free space and walls are drawn", pixels.free > 2000 && pixels.walls > 100);

  // Look around.
  const scale = () => at.evaluate(() => phasescan.view.look.scale);
  const before = await scale();
  await at.mouse.move(500, 400);
  await at.mouse.wheel({ deltaY: -300 });
  check("the wheel zooms", (await scale()) > 1.2 * before);
  const x = () => at.evaluate(() => phasescan.view.look.x);
  const middle = await x();
  await at.mouse.down();
  await at.mouse.move(620, 420, { steps: 4 });
  await at.mouse.up();
  check("dragging moves the map", (await x()) < middle);
  await at.keyboard.press("f");
  check("F follows", (await at.evaluate(() => phasescan.view.look.mode)) === "follow");
  await at.keyboard.press("0");
  check("0 shows all", (await at.evaluate(() => phasescan.view.look.mode)) === "fit");
  await at.waitForFunction(() => phasescan.view.settled);

  // Files.
  await at.type("#name", "my-flat.1");
  await at.click("#save");
  await at.waitForFunction(() => /my-flat\.1/.test(document.getElementById("toasts").textContent), { timeout: 20000 });
  for (const end of [".pgm", ".yaml", ".png", ".state"]) check("my-flat.1" + end + " is there", existsSync(join(folder, "my-flat.1" + end)));
  await at.$eval("#name", (e) => { e.value = "../escape"; });
  await at.click("#save");
  await at.waitForFunction(() => document.querySelector("#toasts .bad"), { timeout: 10000 });
  check("no name leads out of the folder", readdirSync(folder).every((f) => f.startsWith("my-flat.1")));

  // A recording.
  await at.$eval("#name", (e) => { e.value = "drive-1"; });
  await at.click("#record");
  await at.waitForFunction(() => document.getElementById("record-text").textContent === "Stop recording", { timeout: 10000 });
  check("what is recorded is said", (await at.evaluate(() => phasescan.status.recording)).startsWith("drive-1"));
  await sleep(2000);
  await at.click("#record");
  await at.waitForFunction(() => document.getElementById("record-text").textContent === "Record", { timeout: 10000 });
  const recorded = execFileSync(phasescan, ["info", join(folder, "drive-1.mcap"), "--json"], { encoding: "utf8" });
  check("the recording holds scans", JSON.parse(recorded).scans > 5);

  // The pose.
  const robot = await at.evaluate(() => {
    const scan = phasescan.world.state.scan;
    return phasescan.view.screen_of(scan.x, scan.y);
  });
  await at.$eval("#toasts", (e) => e.replaceChildren());
  await at.click("#set-pose");
  check("a hint is shown", await at.$eval("#hint", (e) => !e.hidden));
  await at.mouse.move(...robot);
  await at.mouse.down();
  await at.mouse.move(robot[0] + 60, robot[1] - 30, { steps: 4 });
  await shot(at, "live-pose");
  await at.mouse.up();
  await at.waitForFunction(() => document.querySelector("#toasts div"), { timeout: 10000 });
  check("the pose is taken", (await at.$("#toasts .bad")) === null);
  check("the hint is gone", await at.$eval("#hint", (e) => e.hidden));
  await shot(at, "live-pose-set");

  // Dark, and a phone.
  await at.keyboard.press("d");
  await at.waitForFunction(() => phasescan.view.settled);
  await shot(at, "live-dark");
  const status = await (await fetch(new URL("/api/status", run.url))).json();
  check("/api/status counts scans", status.scans > 20 && status.rate_hz > 2);
  const png = Buffer.from(await (await fetch(new URL("/api/map.png", run.url))).arrayBuffer());
  check("/api/map.png is one", png.subarray(1, 4).toString() === "PNG" && png.length > 500);
  await phone(run);
  await browser_comes_back(at, run);
  await at.close();
}

async function phone(run) {
  const at = await visit(run.url, 390, 844, { touch: true });
  await first_picture(at);
  await at.waitForFunction(() => phasescan.world.state.tiles.size > 4 && phasescan.view.settled, { timeout: 30000 });
  check("a phone need not scroll sideways", (await at.evaluate(() => document.documentElement.scrollWidth)) <= 390);
  const small = await at.$$eval("button", (all) => all.filter((b) => b.offsetParent && b.id !== "close" && b.getBoundingClientRect().height < 42).length);
  check("buttons are large enough for a finger", small === 0);
  await shot(at, "live-phone");
  const before = await at.evaluate(() => phasescan.view.look.scale);
  const client = await at.createCDPSession();
  const fingers = (type, gap) => client.send("Input.dispatchTouchEvent", { type, touchPoints: gap === null ? [] : [-1, 1].map((side, id) => ({ x: 180 + side * gap, y: 450, id })) });
  await fingers("touchStart", 30);
  for (const gap of [45, 60, 90]) await fingers("touchMove", gap);
  await fingers("touchEnd", null);
  check("two fingers zoom", (await at.evaluate(() => phasescan.view.look.scale)) > 1.5 * before);
  await at.tap("#more");
  await sleep(300);
  await shot(at, "live-phone-panel");
  await at.close();
}

/// The server ends and comes back at the same port.
async function browser_comes_back(at, run) {
  const port = new URL(run.url).port;
  await run.stop();
  await at.waitForFunction(() => document.getElementById("state").dataset.state === "offline", { timeout: 10000 });
  await at.waitForFunction(() => !document.getElementById("alarm").hidden, { timeout: 10000 });
  await shot(at, "live-offline");
  const again = await live("--demo", "--seed", "5", "--serve", "127.0.0.1:" + port);
  await at.waitForFunction(() => document.getElementById("state").dataset.state === "ok", { timeout: 30000 });
  await again.stop();
}

async function replay() {
  const log = join(folder, "log.jsonl");
  execFileSync(phasescan, ["simulate", "--world", "flat:7", "--sensor", "rplidar-a1", "--duration", "40", "--out", log], { stdio: ["ignore", "ignore", "inherit"] });
  const run = await live("--replay", log, "--serve", "127.0.0.1:0");
  const at = await visit(run.url, 1100, 760);
  await at.waitForFunction(() => !document.getElementById("replay").hidden, { timeout: 20000 });
  const seek = (share) => at.$eval("#time", (e, v) => { e.value = v; e.dispatchEvent(new Event("input")); e.dispatchEvent(new Event("change")); }, 1000 * share);
  const time = () => at.evaluate(() => phasescan.status.replay.time_s);
  await seek(0.9);
  await at.waitForFunction(() => phasescan.status.replay.time_s > 34, { timeout: 30000 });
  check("no scan was left out", (await at.evaluate(() => phasescan.status.dropped)) === 0);
  await at.click("#play");
  await at.waitForFunction(() => phasescan.status.replay.speed === 0, { timeout: 10000 });
  const held = await time();
  await sleep(1500);
  check("a held log stands still", Math.abs((await time()) - held) < 0.3);
  await shot(at, "live-replay");
  await at.click("#play");
  await seek(0.1);
  await at.waitForFunction(() => phasescan.status.replay.time_s < 20, { timeout: 30000 });
  check("going back begins the map again", (await at.evaluate(() => phasescan.status.scans)) < 120);
  await at.close();
  await run.stop();
}

/// Holds the log at a moment at which the state is this one.
async function held_while(at, state) {
  const is = () => at.$eval("#state", (e, s) => e.dataset.state === s, state);
  for (let i = 0; i < 40; ++i) {
    await at.waitForFunction((s) => document.getElementById("state").dataset.state === s, { timeout: 60000 }, state);
    await at.click("#play");
    await at.waitForFunction(() => phasescan.status.replay.speed === 0, { timeout: 10000 });
    await sleep(500);
    if (await is()) return;
    await at.click("#play");
    await at.waitForFunction(() => phasescan.status.replay.speed > 0, { timeout: 10000 });  // else the next click plays, too
  }
  check("the log can be held while it is " + state, false);
}

/// A drive about a known flat, then about another one that is on no map: as if somebody had carried the robot away.
async function lost() {
  const simulate = (world, seconds, name) => {
    execFileSync(phasescan, ["simulate", "--world", world, "--sensor", "rplidar-a1", "--duration", String(seconds), "--out", join(folder, name)], { stdio: ["ignore", "ignore", "inherit"] });
    return readFileSync(join(folder, name), "utf8").trim().split("\n").map((line) => JSON.parse(line));
  };
  const home = simulate("flat:7", 40, "home.jsonl");
  execFileSync(phasescan, ["slam", join(folder, "home.jsonl"), "--out", join(folder, "home")], { stdio: ["ignore", "ignore", "inherit"] });
  const away = simulate("office:3", 60, "away.jsonl"), kept = home.slice(0, 60), last = kept[kept.length - 1].stamp;
  const lines = [...kept, ...away.map((scan) => ({ ...scan, stamp: (scan.stamp ?? 0) + last + 0.2 }))];
  writeFileSync(join(folder, "carried.jsonl"), lines.map((scan) => JSON.stringify(scan)).join("\n") + "\n");
  const run = await live("--replay", join(folder, "carried.jsonl"), "--map", join(folder, "home/map.yaml"), "--serve", "127.0.0.1:0");
  const at = await visit(run.url, 1280, 800);
  await at.waitForFunction(() => phasescan.world.state.tiles.size > 4 && document.getElementById("state").dataset.state === "ok", { timeout: 20000 });
  check("the map is one that is known", await at.evaluate(() => phasescan.status.known_map));
  check("there is no run to save", await at.$eval("#save", (e) => e.disabled));
  await shot(at, "live-known-map");
  const before = await known(at);
  // It may find places that look alike, and lose them again: what is said is read at one moment.
  const said = await (await at.waitForFunction(() => document.getElementById("state").dataset.state === "lost" && phasescan.view.settled && {
    word: document.getElementById("state-name").textContent, alarm: !document.getElementById("alarm").hidden,
    what: document.getElementById("alarm-text").textContent, title: document.title,
  }, { timeout: 60000 })).jsonValue();
  check("the word is lost", said.word === "Lost");
  check("it says what to do", said.alarm && /where it is/.test(said.what));
  check("the title says it", said.title.startsWith("Lost"));
  check("nothing is drawn into a known map", (await known(at)) === before);
  await held_while(at, "lost");
  await shot(at, "live-lost");
  await at.keyboard.press("d");
  await shot(at, "live-lost-dark");
  await at.click("#play");
  await at.waitForFunction(() => document.getElementById("state").dataset.state === "ambiguous", { timeout: 60000 });
  await shot(at, "live-ambiguous-dark");
  await at.click("#find");
  await at.waitForFunction(() => /whole map/.test(document.getElementById("toasts").textContent), { timeout: 10000 });
  await at.$eval("#toasts", (e) => e.replaceChildren());
  await at.click("#set-pose");
  await at.mouse.move(600, 400);
  await at.mouse.down();
  await at.mouse.move(640, 400, { steps: 3 });
  await at.mouse.up();
  await at.waitForFunction(() => /near there/.test(document.getElementById("toasts").textContent), { timeout: 10000 });
  await sleep(500);
  check("a wrong place is not called right", (await at.evaluate(() => phasescan.world.state.scan.state)) !== "ok");
  await at.close();
  await run.stop();
}

try {
  await demo();
  await replay();
  await lost();
} finally {
  for (const child of running) child.kill("SIGKILL");
  await browser.close();
  rmSync(folder, { recursive: true });
}
